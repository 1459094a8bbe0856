//! Render: runs a scene and draws its bodies at a time, or a film of pictures, without a window system.

use std::collections::BTreeMap;
use std::num::NonZeroU16;
use std::path::Path;
use std::sync::Arc;

use forerun::timeline::Progress;
use forerun::{
    Aabb, Body, BodyId, Frame, Pose, Scene, Shape, Threads, Timeline, TimelineSettings, Vec3, timeline_of,
};

use crate::args::RenderArgs;
use crate::baking::open_scene;
use crate::failure::Failure;
use crate::output::print;
use crate::picture::{Camera, FIXED_COLOUR, Facet, Ground, Item, View, colour_of, draw, facets, square_for};
use crate::progress;
use crate::results::make_folder;

/// Where the camera is, seen from the bodies.
const FROM: Vec3 = Vec3::new(0.55, 0.42, 1.0);
/// Of so many bodies one on each side does not count for what must be in view: a stray one would make all others small.
const STRAY: usize = 100;

/// `forerun render`.
pub(crate) fn run(args: &RenderArgs) -> Result<(), Failure> {
    if args.output.is_none() && args.film.is_none() {
        let message = "render: nothing to write; give -o FILE.png for a picture or --film DIR for many";
        return Err(Failure::Input(message.to_owned()));
    }
    let scene = open_scene(&args.scene)?;
    let threads = match args.threads.and_then(NonZeroU16::new) {
        Some(count) => Threads::exactly(count)?,
        None => Threads::all()?,
    };
    let last = args.time.unwrap_or(f64::from(scene.seconds));
    let film: Vec<f64> = match &args.film {
        Some(_) => (0..).map(|i| f64::from(i) / args.fps).take_while(|time| *time <= last).collect(),
        None => Vec::new(),
    };
    let times: Vec<f64> = film.iter().copied().chain([last]).collect();
    let scenes = threads.install(|| compute(&scene, &args.scene, &times))?;
    let Some((at_end, in_film)) = scenes.split_last() else {
        return Ok(());
    };
    let mut studio = Studio { size: args.size, surfaces: BTreeMap::new() };
    if let Some(path) = &args.output {
        studio.draw(at_end, &Scenery::of([at_end.as_slice()]), path)?;
    }
    if let Some(folder) = &args.film {
        make_folder(folder)?;
        // One place for the whole film: the camera does not move.
        let seen = Scenery::of(in_film.iter().map(Vec::as_slice));
        let bar = progress::bar(in_film.len() as u64, "drawing");
        for (i, shown) in in_film.iter().enumerate() {
            studio.draw(shown, &seen, &folder.join(format!("{i:05}.png")))?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        print(&format!("wrote {} pictures to {}", in_film.len(), folder.display()))?;
    }
    args.output.as_ref().map_or(Ok(()), |path| print(&format!("wrote {}", path.display())))
}

/// A body at a time.
struct Shown {
    id: BodyId,
    body: Arc<Body>,
    /// Of its own frame.
    pose: Pose,
}

/// The bodies at each of the times (seconds, rising).
fn compute(scene: &Scene, typed: &str, times: &[f64]) -> Result<Vec<Vec<Shown>>, Failure> {
    let settings = TimelineSettings { lookahead: 1, past: 1, ..TimelineSettings::default() };
    let mut timeline = timeline_of(scene, settings)?;
    let frame_seconds = f64::from(scene.frame_seconds);
    let frame_of = |time: f64| (time / frame_seconds).floor() as u64;
    let bar = progress::bar(times.last().map_or(0, |time| frame_of(*time)), typed);
    let mut samples = Vec::new();
    let mut all = Vec::new();
    for time in times {
        let frame = frame_of(*time);
        advance_to(&mut timeline, frame, &|done| bar.set_position(done));
        timeline.snapshot().sample_all(*time, &mut samples);
        let body_at = |id| timeline.body_at(id, Frame(frame)).cloned();
        all.push(
            samples
                .iter()
                .filter_map(|(id, sample)| Some(Shown { id: *id, body: body_at(*id)?, pose: sample.pose }))
                .collect(),
        );
    }
    bar.finish_and_clear();
    Ok(all)
}

/// Computes until the frame and the one after it are known.
fn advance_to(timeline: &mut Timeline, frame: u64, done: &dyn Fn(u64)) {
    for next in timeline.display().0..=frame {
        timeline.set_display(Frame(next));
        while timeline.advance() != Progress::Idle {}
        done(next);
    }
}

/// What has to be in view.
struct Scenery {
    /// Around each of the things. Not empty.
    boxes: Vec<Aabb>,
    /// Around all of them.
    whole: Aabb,
}

impl Scenery {
    /// What moves, less a few that strayed; where nothing does, what has an end.
    fn of<'a>(pictures: impl IntoIterator<Item = &'a [Shown]>) -> Scenery {
        let (mut moving, mut fixed) = (Vec::new(), Vec::new());
        for shown in pictures.into_iter().flatten() {
            let bounds = shown.body.shape.aabb(&shown.pose);
            if bounds.min.is_finite() && bounds.max.is_finite() {
                if shown.body.is_dynamic() { moving.push(bounds) } else { fixed.push(bounds) }
            }
        }
        let mut boxes = if moving.is_empty() { fixed } else { moving };
        if boxes.is_empty() {
            boxes.push(Aabb { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::ONE });
        }
        let strays = boxes.len() / STRAY;
        let (mut min, mut max) = (Vec3::ZERO, Vec3::ZERO);
        for axis in 0..3 {
            let mut lows: Vec<f32> = boxes.iter().map(|aabb| aabb.min[axis]).collect();
            let mut highs: Vec<f32> = boxes.iter().map(|aabb| aabb.max[axis]).collect();
            lows.sort_by(f32::total_cmp);
            highs.sort_by(f32::total_cmp);
            min[axis] = lows[strays];
            max[axis] = highs[highs.len() - 1 - strays];
        }
        let is_stray = |aabb: &Aabb| aabb.min.cmplt(min).any() || aabb.max.cmpgt(max).any();
        let whole = Aabb { min, max };
        boxes.retain(|aabb| !is_stray(aabb));
        // Where every box is the farthest in some direction.
        if boxes.is_empty() {
            boxes.push(whole);
        }
        Scenery { boxes, whole }
    }

    fn corners(&self) -> impl Iterator<Item = Vec3> {
        self.boxes.iter().flat_map(|Aabb { min, max }| {
            (0..8).map(move |k| {
                let pick = |axis: usize| if k >> axis & 1 == 0 { min[axis] } else { max[axis] };
                Vec3::new(pick(0), pick(1), pick(2))
            })
        })
    }
}

/// What tells shapes apart that do not look the same: where a shared one is in memory, or a kind and its numbers.
type Look = (usize, [u32; 3]);

/// Draws, and keeps surfaces from picture to picture.
struct Studio {
    size: [u32; 2],
    surfaces: BTreeMap<Look, Arc<[Facet]>>,
}

impl Studio {
    fn draw(&mut self, shown: &[Shown], seen: &Scenery, path: &Path) -> Result<(), Failure> {
        let [width, height] = self.size;
        let whole = seen.whole;
        let square = square_for((whole.max - whole.min).max_element());
        let grounds: Vec<Ground> = shown
            .iter()
            .filter(|shown| matches!(shown.body.shape, Shape::HalfSpace))
            .map(|shown| Ground { pose: shown.pose, square })
            .collect();
        let items: Vec<Item> = shown.iter().map(|shown| self.item(shown)).collect();
        let camera = Camera::fitting(seen.corners(), FROM, width as f32 / height as f32);
        draw(&View { camera, items: &items, grounds: &grounds, seen: whole }, width, height).write(path)
    }

    fn item(&mut self, shown: &Shown) -> Item {
        let shape = &shown.body.shape;
        let surface = self.surfaces.entry(look_of(shape)).or_insert_with(|| facets(shape).into());
        let colour = if shown.body.is_dynamic() { colour_of(shown.id.0) } else { FIXED_COLOUR };
        Item { facets: surface.clone(), pose: shown.pose, colour }
    }
}

fn look_of(shape: &Shape) -> Look {
    let bits = |numbers: [f32; 3]| numbers.map(f32::to_bits);
    match shape {
        Shape::HalfSpace => (0, [0; 3]),
        Shape::Sphere(sphere) => (1, bits([sphere.radius, 0.0, 0.0])),
        Shape::Cuboid(cuboid) => (2, bits(cuboid.half_extents.to_array())),
        Shape::Capsule(capsule) => (3, bits([capsule.half_height, capsule.radius, 0.0])),
        Shape::Cylinder(cylinder) => (4, bits([cylinder.half_height, cylinder.radius, 0.0])),
        // All bodies are kept as long as there are pictures to draw, and no address is so small.
        Shape::Hull(hull) => (Arc::as_ptr(hull).addr(), [0; 3]),
        Shape::Compound(compound) => (Arc::as_ptr(compound).addr(), [0; 3]),
        Shape::Mesh(mesh) => (Arc::as_ptr(mesh).addr(), [0; 3]),
    }
}
