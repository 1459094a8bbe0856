//! What of a picture is kept: screenshots, films, the numbers behind the plots.

use three_d::{DepthTexture2D, Interpolation, RenderTarget, Texture2D, Viewport, Wrapping};

use super::{Viewer, scenery};
use crate::capture::{self, Drawn, FilmSize, Shot};
use crate::series;

/// A window that was not drawn for longer (a hidden page, a machine asleep) goes on from where it was. Seconds.
const GAP_MAX_S: f64 = 1.0;

/// Larger pictures are not drawn twice as large. Pixels.
const SMOOTH_PIXELS: u32 = 2560 * 1440;

impl Viewer {
    /// The session's clock goes with the window's; while a film is taken, by a picture of the film at a time.
    pub(super) fn turn_clock(&mut self, elapsed_s: f64) {
        let elapsed_s = elapsed_s.min(GAP_MAX_S);
        let goes_on_s = match &mut self.capture.film {
            Some(film) => film.tick(elapsed_s),
            None => elapsed_s,
        };
        self.filmed = self.capture.film.is_some() && goes_on_s > 0.0;
        self.clock_s += goes_on_s;
    }

    /// Keeps of this picture what is wanted, panels and all. What is wanted without them is drawn anew: in the window the scene is where panels leave room.
    pub(super) fn keep_picture(&mut self, window: &RenderTarget<'_>) {
        let scale = self.window.pixels_per_point * self.view.scale;
        self.capture.take(Drawn::All, scale, &self.session, || Shot::of(window));
        let size = [window.width(), window.height()];
        if self.capture.is_wanted(Drawn::Scene) {
            let drawn = self.draw_apart(size);
            let bare = if drawn.size == size { drawn } else { drawn.halved() };
            self.capture.take(Drawn::Scene, scale, &self.session, || bare.clone());
        }
        let Some(film) = self.capture.film.as_ref().filter(|_| self.filmed) else { return };
        let (settings, size) = (film.settings, film.size);
        let with_panels = settings.panels && settings.size == FilmSize::Window;
        // The writer makes it as large as the film.
        let shot = if with_panels { Shot::of(window) } else { self.draw_apart(size) };
        if let Some(film) = &mut self.capture.film {
            film.take(shot);
        }
    }

    /// Draws the scene, without panels.
    pub(super) fn draw_scene(&mut self, target: &RenderTarget<'_>, viewport: Viewport) {
        let Viewer { session, view, camera, hands, painter, .. } = self;
        let Some(scenery) = scenery(session, camera, view, hands) else { return };
        painter.draw(target, viewport, &scenery);
    }

    /// The scene in a size of its own, as it is in a window without panels; twice as large, if that is not too much: the mean of each four makes edges smooth.
    fn draw_apart(&mut self, size: [u32; 2]) -> Shot {
        let times = if size[0] * size[1] <= SMOOTH_PIXELS { 2 } else { 1 };
        let [width, height] = size.map(|side| times * side.max(1));
        let context = self.context.clone();
        let smooth = Interpolation::Linear;
        let clamp = Wrapping::ClampToEdge;
        let colour =
            Texture2D::new_empty::<[u8; 4]>(&context, width, height, smooth, smooth, None, clamp, clamp);
        let depth = DepthTexture2D::new::<f32>(&context, width, height, clamp, clamp);
        let target = RenderTarget::new(colour.as_color_target(None), depth.as_depth_target());
        let camera = self.camera;
        self.camera = camera.without_panels(width as f32 / height as f32);
        self.draw_scene(&target, Viewport::new_at_origo(width, height));
        self.camera = camera;
        Shot::of(&target)
    }

    /// Writes the numbers behind the plots.
    pub(super) fn keep_numbers(&mut self) {
        let stem = capture::stem(&self.session);
        let series = &self.series;
        let tables = [
            ("queue", series::pictures_csv(&series.pictures)),
            ("steps", series::steps_csv(&series.steps)),
            ("edits", series::edits_csv(&series.edits)),
        ];
        for (name, table) in tables {
            self.capture.save_text(&format!("{stem}-{name}.csv"), table);
        }
    }
}
