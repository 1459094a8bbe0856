//! Window: the system's window and its events; what comes of them is the viewer's.

mod errand;
mod pace;

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::time::Duration;

use three_d::{FrameInputGenerator, SurfaceSettings, WindowedContext};
use winit::dpi::LogicalSize;
use winit::event::{Event, WindowEvent};
use winit::event_loop::{ControlFlow, EventLoop, EventLoopBuilder};
use winit::window::{Window, WindowBuilder};

use self::errand::Errand;
use self::pace::WindowPace;
use crate::host::{self, Host, SceneSource};
use crate::settings::{Settings, WindowPlace};
use crate::viewer::Viewer;

/// Files that are still being written when the window closes are waited for so long, and looked at so often.
const LAST_FILES: Duration = Duration::from_secs(20);
const LOOK_AGAIN: Duration = Duration::from_millis(10);

/// How the window begins.
#[derive(Debug)]
pub struct WindowOptions {
    /// What is open.
    pub source: SceneSource,
    /// Where it runs.
    pub host: Host,
    /// Width and height in points; none for what the system gives.
    pub size: Option<[u32; 2]>,
    /// A file that the state is written to, as JSON, after every picture: for scripts.
    pub report: Option<PathBuf>,
    /// Display time to begin at. Seconds.
    pub time_s: Option<f64>,
    /// Whether display time stands still at first.
    pub paused: bool,
    /// Keeps one picture and ends.
    pub screenshot: Option<Screenshot>,
}

/// One picture of the window for a file, after which the viewer ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Screenshot {
    /// The PNG file.
    pub path: PathBuf,
    /// How long after the scene began. Seconds.
    pub after_s: f64,
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
    let settings = Settings::of_text(&host::load_settings().unwrap_or_default());
    let place = match options.size {
        Some(size) => WindowPlace { size, maximized: false },
        None => settings.window,
    };
    let [width, height] = place.size;
    let window = WindowBuilder::new()
        .with_title("forerun")
        .with_min_inner_size(LogicalSize::new(480, 320))
        .with_inner_size(LogicalSize::new(width, height))
        .with_maximized(place.maximized)
        .build(&events)
        .map_err(|error| NoWindow::because(error.to_string()))?;
    let context = context_of(&window)?;
    let mut viewer = Viewer::new(&context, options.host, options.source, settings);
    if options.screenshot.is_some() {
        viewer.keeper.silent = true;
        viewer.keeper.settings.greeted = true;
    }
    let mut inputs = FrameInputGenerator::from_winit_window(&window);
    let mut reporter = options.report.map(Reporter::new);
    let mut errand =
        Errand { time_s: options.time_s, paused: options.paused, screenshot: options.screenshot };
    // A size that was asked for is not what the user made of the window.
    let remembers = options.size.is_none();
    let mut title = String::new();
    let mut pace = WindowPace::new();
    events.run(move |event, _, control| match event {
        Event::MainEventsCleared if pace.is_due() => window.request_redraw(),
        Event::MainEventsCleared => *control = pace.wait(),
        Event::RedrawRequested(_) => {
            if pace.has_waited() {
                viewer.series.leave_out_interval();
            }
            let output = viewer.picture(inputs.generate(&context));
            let done = errand.run(&mut viewer);
            if viewer.title() != title {
                title = viewer.title();
                window.set_title(&title);
            }
            pace.drawn(viewer.is_still() || window.is_minimized() == Some(true));
            let ended = output.exit || done.is_some() || context.swap_buffers().is_err();
            // What a script reads is on the screen already.
            if let Some(reporter) = &mut reporter {
                reporter.write(&viewer);
            }
            *control = if ended { ControlFlow::ExitWithCode(done.unwrap_or(0)) } else { pace.wait() };
        }
        Event::WindowEvent { event, .. } => {
            pace.stir();
            inputs.handle_winit_window_event(&event);
            match event {
                WindowEvent::Resized(size) => context.resize(size),
                WindowEvent::ScaleFactorChanged { new_inner_size, .. } => context.resize(*new_inner_size),
                WindowEvent::DroppedFile(path) => viewer.session.open(SceneSource::File(path)),
                WindowEvent::Focused(false) => viewer.lose_focus(),
                WindowEvent::CloseRequested => *control = ControlFlow::Exit,
                _ => {}
            }
        }
        Event::LoopDestroyed => {
            if remembers {
                viewer.keeper.place(place_of(&window));
            }
            viewer.keeper.keep(&viewer.view);
            finish(&mut viewer);
        }
        _ => {}
    });
}

/// The process ends with the window: what is being written is waited for.
fn finish(viewer: &mut Viewer) {
    let mut waited = Duration::ZERO;
    while !viewer.capture.finish() && waited < LAST_FILES {
        std::thread::sleep(LOOK_AGAIN);
        waited += LOOK_AGAIN;
    }
}

fn place_of(window: &Window) -> WindowPlace {
    let size = window.inner_size().to_logical::<f64>(window.scale_factor());
    let size = [size.width.round() as u32, size.height.round() as u32];
    WindowPlace { size, maximized: window.is_maximized() }
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
