//! Window: the system's window and its events; what comes of them is the viewer's.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use three_d::{FrameInputGenerator, SurfaceSettings, WindowedContext};
use winit::event::{Event, WindowEvent};
use winit::event_loop::{ControlFlow, EventLoop, EventLoopBuilder};
use winit::window::WindowBuilder;

use crate::host::{Host, SceneSource};
use crate::view::View;
use crate::viewer::Viewer;

/// How the window begins.
#[derive(Debug)]
pub struct WindowOptions {
    /// What is open.
    pub source: SceneSource,
    /// Where it runs.
    pub host: Host,
    /// Width and height in points; none for what the system gives.
    pub size: Option<[u32; 2]>,
    /// A file that the state is written to, as JSON, whenever it changes: for scripts.
    pub report: Option<PathBuf>,
}

/// Why there is no window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoWindow {
    cause: String,
}

impl fmt::Display for NoWindow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no window can be opened: {}", self.cause)
    }
}

impl std::error::Error for NoWindow {}

impl NoWindow {
    fn because(cause: impl Into<String>) -> NoWindow {
        NoWindow { cause: cause.into() }
    }
}

/// Opens a window and plays in it; the process ends with the window.
///
/// # Errors
/// When there is no display, or it cannot draw with OpenGL.
pub fn open(options: WindowOptions) -> Result<(), NoWindow> {
    let events = event_loop()?;
    let window = WindowBuilder::new().with_title("forerun");
    let window = match options.size {
        Some([width, height]) => window.with_inner_size(winit::dpi::LogicalSize::new(width, height)),
        None => window.with_maximized(true),
    };
    let window = window.build(&events).map_err(|error| NoWindow::because(error.to_string()))?;
    let context = context_of(&window)?;
    let mut viewer = Viewer::new(&context, options.host, options.source, View::default());
    let mut inputs = FrameInputGenerator::from_winit_window(&window);
    let mut reporter = options.report.map(Reporter::new);
    events.run(move |event, _, control| match event {
        Event::MainEventsCleared => window.request_redraw(),
        Event::RedrawRequested(_) => {
            let output = viewer.picture(inputs.generate(&context));
            if let Some(reporter) = &mut reporter {
                reporter.write(&viewer);
            }
            *control = if output.exit || context.swap_buffers().is_err() {
                ControlFlow::Exit
            } else {
                ControlFlow::Poll
            };
        }
        Event::WindowEvent { event, .. } => {
            inputs.handle_winit_window_event(&event);
            match event {
                WindowEvent::Resized(size) => context.resize(size),
                WindowEvent::ScaleFactorChanged { new_inner_size, .. } => context.resize(*new_inner_size),
                WindowEvent::DroppedFile(path) => viewer.session.open(SceneSource::File(path)),
                WindowEvent::CloseRequested => *control = ControlFlow::Exit,
                _ => {}
            }
        }
        _ => {}
    });
}

/// The library panics where there is no display, and says why on the way.
fn event_loop() -> Result<EventLoop<()>, NoWindow> {
    let named = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if cfg!(all(unix, not(target_os = "macos"))) && !named("DISPLAY") && !named("WAYLAND_DISPLAY") {
        return Err(NoWindow::because("neither DISPLAY nor WAYLAND_DISPLAY names a display"));
    }
    quietly(|| EventLoopBuilder::new().build())
        .ok_or_else(|| NoWindow::because("the display does not answer"))
}

fn context_of(window: &winit::window::Window) -> Result<WindowedContext, NoWindow> {
    let without = SurfaceSettings { multisamples: 0, ..SurfaceSettings::default() };
    [SurfaceSettings::default(), without]
        .into_iter()
        .find_map(|settings| quietly(|| WindowedContext::from_winit_window(window, settings).ok()).flatten())
        .ok_or_else(|| NoWindow::because("the display does not draw with OpenGL 3.3 or newer"))
}

/// Does what may panic in a library; none if it did.
fn quietly<T>(work: impl FnOnce() -> T) -> Option<T> {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let done = catch_unwind(AssertUnwindSafe(work)).ok();
    std::panic::set_hook(hook);
    done
}

/// Writes the state for scripts.
#[derive(Debug)]
struct Reporter {
    path: PathBuf,
}

impl Reporter {
    fn new(path: PathBuf) -> Reporter {
        Reporter { path }
    }

    fn write(&mut self, viewer: &Viewer) {
        // Whole or not at all: a script never reads half of it. A script that cannot read it says so itself.
        let Ok(text) = serde_json::to_string(&viewer.report()) else { return };
        let part = self.path.with_extension("part");
        if std::fs::write(&part, text).is_ok() {
            let _ = std::fs::rename(&part, &self.path);
        }
    }
}
