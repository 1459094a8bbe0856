//! Mesh: everything about a mesh file: what it has, what was mended, what its field costs and how good it is; pictures of it.

use std::sync::Arc;

use forerun::geometry::mesh_file::{
    LIKELY_MILLIMETRES, MeshFileOptions, TriangleList, UpAxis, load_triangles,
};
use forerun::geometry::sdf::Field;
use forerun::geometry::shape::{Enclosure, Inside, Mesh, MeshOptions};
use forerun::scene::MeshBaking;
use forerun::{Aabb, Clock, Pose, Shape, Vec3};
use serde::Serialize;

use crate::args::{MeshArgs, UpArg};
use crate::baking::{Warnings, Watch};
use crate::cache;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::picture::{Camera, Canvas, Ground, Item, View, colour_of, draw, draw_slices, facets, square_for};

/// Size of each of the two views of `--picture`. Pixels.
const VIEW: u32 = 720;

/// What is known of a mesh; the fields are those of `mesh --json`.
#[derive(Debug, Serialize)]
struct MeshReport {
    file: String,
    scale: f32,
    up: UpArg,
    /// As the file has them.
    vertices_given: usize,
    triangles_given: usize,
    /// As they are used.
    vertices: usize,
    triangles: usize,
    /// Parts of the surface that do not hang together.
    shells: usize,
    /// `closed`, `mended` or `open`.
    enclosure: &'static str,
    /// Of a mended one, what keeps it from being closed, in words.
    why_not_closed: Option<String>,
    /// What was mended, in words.
    repairs: String,
    min_m: [f32; 3],
    max_m: [f32; 3],
    /// None without an inside.
    solid: Option<Solid>,
    /// None without an inside.
    field: Option<FieldReport>,
    samples: usize,
    /// Field, samples and what else contact needs.
    bytes: usize,
    bake_ms: f64,
    /// Whether the field was baked in an earlier run.
    cached: bool,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Solid {
    volume_m3: f32,
    density: f32,
    mass_kg: f32,
    centre_of_mass_m: [f32; 3],
    /// About the centre of mass, along the principal axes.
    principal_inertia_kg_m2: [f32; 3],
    half_thickness_m: f32,
}

#[derive(Debug, Serialize)]
struct FieldReport {
    cell_m: f32,
    bytes: usize,
    /// How far from 0 the field is at points spread over the triangles, as it states itself.
    error_mean_m: f32,
    error_max_m: f32,
}

impl FieldReport {
    fn of(field: &Field) -> FieldReport {
        let error = field.error().distance;
        FieldReport {
            cell_m: field.cell(),
            bytes: field.bytes(),
            error_mean_m: error.mean,
            error_max_m: error.max,
        }
    }
}

/// `forerun mesh`.
pub(crate) fn run(args: &MeshArgs) -> Result<(), Failure> {
    let options = MeshFileOptions { scale: args.scale, up: args.up.into() };
    let list = load_triangles(&args.file, options)?;
    let given = (list.vertices.len(), list.triangles.len());
    let made = make(args, list)?;
    let report = made.report(args, given);
    if args.json {
        print_json(&report)?;
    } else {
        print_report(&report)?;
    }
    let mut written = Vec::new();
    if let Some(path) = &args.picture {
        draw_views(&made.mesh).write(path)?;
        written.push(path);
    }
    if let Some(path) = &args.slice {
        let slices = draw_slices(&made.mesh, made.middle());
        slices.map_err(|error| Failure::picture(path, &error))?.write(path)?;
        written.push(path);
    }
    if args.json {
        return Ok(());
    }
    written.into_iter().try_for_each(|path| print(&format!("wrote {}", path.display())))
}

/// A mesh and how it came to be.
struct Made {
    mesh: Arc<Mesh>,
    kept: bool,
    bake_ms: f64,
    warnings: Vec<String>,
}

/// Makes the mesh as a body would have it; if it can have no inside, as an open one.
fn make(args: &MeshArgs, list: TriangleList) -> Result<Made, Failure> {
    let watch = Arc::new(Watch::new(Warnings::Kept));
    let baking = MeshBaking {
        cache: if args.no_cache { None } else { cache::of_meshes() },
        watch: Some(watch.clone()),
    };
    let name = args.file.file_name().unwrap_or_default().to_string_lossy();
    let clock = Clock::system();
    let start = clock.now();
    let wished = |inside| MeshOptions { inside, cell: args.cell };
    let mut warnings = Vec::new();
    let baked = baking.make(&name, list.clone(), wished(Inside::Needed)).or_else(|error| {
        warnings.push(format!("it can be a fixed body only (open = true): {error}"));
        baking.make(&name, list, wished(Inside::Optional))
    });
    let baked = baked.map_err(|error| Failure::Input(format!("{}: {error}", args.file.display())))?;
    let bake_ms = 1000.0 * (clock.now() - start).as_secs_f64();
    warnings.extend(watch.warnings());
    Ok(Made { mesh: Arc::new(baked.mesh), kept: baked.kept, bake_ms, warnings })
}

impl Made {
    fn shape(&self) -> Shape {
        Shape::Mesh(self.mesh.clone())
    }

    /// The centre of mass, or of the box where there is none.
    fn middle(&self) -> Vec3 {
        let Aabb { min, max } = self.mesh.bounds();
        if self.mesh.has_inside() { self.shape().mass_properties(1.0).centre } else { 0.5 * (min + max) }
    }

    fn report(&self, args: &MeshArgs, given: (usize, usize)) -> MeshReport {
        let mesh = &self.mesh;
        let Aabb { min, max } = mesh.bounds();
        let collider = mesh.collider();
        let solid = mesh.has_inside().then(|| {
            let mass = self.shape().mass_properties(args.density);
            Solid {
                volume_m3: self.shape().mass_properties(1.0).mass,
                density: args.density,
                mass_kg: mass.mass,
                centre_of_mass_m: mass.centre.to_array(),
                principal_inertia_kg_m2: mass.principal_inertia.to_array(),
                half_thickness_m: mesh.half_thickness(),
            }
        });
        let field = collider.field.as_ref();
        MeshReport {
            file: args.file.display().to_string(),
            scale: args.scale,
            up: args.up,
            vertices_given: given.0,
            triangles_given: given.1,
            vertices: mesh.vertices.len(),
            triangles: mesh.triangles.len(),
            shells: mesh.shells(),
            enclosure: match mesh.enclosure {
                Enclosure::Closed => "closed",
                Enclosure::Mended => "mended",
                Enclosure::Open => "open",
            },
            why_not_closed: (mesh.enclosure == Enclosure::Mended).then(|| mesh.repairs.why_not_closed()),
            repairs: mesh.repairs.to_string(),
            min_m: min.to_array(),
            max_m: max.to_array(),
            solid,
            field: field.map(FieldReport::of),
            samples: collider.samples.count(),
            bytes: collider.bytes(),
            bake_ms: self.bake_ms,
            cached: self.kept,
            warnings: [&self.warnings[..], &oddities(mesh, args)[..]].concat(),
        }
    }
}

/// What is allowed and yet probably not meant.
fn oddities(mesh: &Mesh, args: &MeshArgs) -> Vec<String> {
    let mut found = Vec::new();
    let size = (mesh.bounds().max - mesh.bounds().min).max_element();
    if mesh.has_inside() && size > LIKELY_MILLIMETRES {
        found.push(format!(
            "it is {size} m large: if the file is in millimetres, say --scale {} here and scale = {} in a scene",
            0.001 * args.scale,
            0.001 * args.scale
        ));
    }
    if size < 0.001 {
        found.push(format!("it is only {size:e} m large: give the factor to metres with --scale"));
    }
    let field = mesh.collider().field.as_ref();
    if let Some(field) = field.filter(|field| field.cell() > mesh.half_thickness()) {
        found.push(format!(
            "its thinnest parts, about {:.2e} m, are less than two cells of the field thick ({:.2e} m each): what hits them fast may \
             pass through; make them thicker, or cut the mesh in pieces",
            2.0 * mesh.half_thickness(),
            field.cell()
        ));
    }
    let crowded = mesh.collider().crowded_cells();
    if crowded > 0 {
        found.push(format!(
            "{crowded} cells of the field at sharp edges have too many triangles to be asked: what touches there sees edges a little rounded; \
             simplify the mesh"
        ));
    }
    found
}

fn print_report(report: &MeshReport) -> Result<(), Failure> {
    let line = |name: &str, value: String| print(&format!("  {name:<16} {value}"));
    let vector = |v: [f32; 3]| format!("({:.4}, {:.4}, {:.4})", v[0], v[1], v[2]);
    let size: Vec<f32> = report.max_m.iter().zip(report.min_m).map(|(max, min)| max - min).collect();
    print(&report.file)?;
    line("in the file", format!("{} triangles, {} vertices", report.triangles_given, report.vertices_given))?;
    line(
        "used",
        format!("{} triangles, {} vertices, shells: {}", report.triangles, report.vertices, report.shells),
    )?;
    line("mended", report.repairs.clone())?;
    line(
        "surface",
        match (report.enclosure, &report.why_not_closed) {
            ("closed", _) => "closed (watertight)".to_owned(),
            (_, Some(why)) => format!("not quite closed: {why}; what is inside is clear all the same"),
            _ => "open: for fixed bodies".to_owned(),
        },
    )?;
    line(
        "size",
        format!(
            "{:.4} x {:.4} x {:.4} m, from {} to {}",
            size[0],
            size[1],
            size[2],
            vector(report.min_m),
            vector(report.max_m)
        ),
    )?;
    if let Some(solid) = &report.solid {
        let [x, y, z] = solid.principal_inertia_kg_m2;
        line("volume", format!("{:.6e} m³", solid.volume_m3))?;
        line("mass", format!("{:.4} kg at {} kg/m³", solid.mass_kg, solid.density))?;
        line("centre of mass", format!("{} m", vector(solid.centre_of_mass_m)))?;
        line("inertia", format!("({x:.4e}, {y:.4e}, {z:.4e}) kg m² along the principal axes"))?;
        line("half thickness", format!("{:.5} m", solid.half_thickness_m))?;
    }
    if let Some(field) = &report.field {
        let kib = field.bytes as f64 / 1024.0;
        line("field", format!("{kib:.1} KiB, cells of {:.3} mm", 1000.0 * field.cell_m))?;
        let [mean, max] = [field.error_mean_m, field.error_max_m].map(|error| 1000.0 * error);
        line("field error", format!("on the triangles {mean:.4} mm in the mean, {max:.4} mm at most"))?;
    }
    line("samples", report.samples.to_string())?;
    line("memory", format!("{:.1} KiB for contact in all", report.bytes as f64 / 1024.0))?;
    let from = if report.cached { "field kept from an earlier run" } else { "baked" };
    line("time", format!("{:.1} ms, {from}", report.bake_ms))?;
    report.warnings.iter().try_for_each(|warning| print(&format!("warning: {warning}")))
}

/// Two views from opposite sides.
fn draw_views(mesh: &Arc<Mesh>) -> Canvas {
    let seen = mesh.bounds();
    let item = Item {
        facets: facets(&Shape::Mesh(mesh.clone())).into(),
        pose: Pose::IDENTITY,
        colour: colour_of(1),
    };
    let ground = Ground {
        pose: Pose::from_position(Vec3::Y * seen.min.y),
        square: square_for((seen.max - seen.min).max_element()),
    };
    let mut canvas = Canvas::new(2 * VIEW, VIEW);
    for (left, from) in [(0, Vec3::new(0.6, 0.5, 1.0)), (VIEW, Vec3::new(-0.8, 0.7, -1.0))] {
        let camera = Camera::fitting(mesh.vertices.iter().copied(), from, 1.0);
        let view = View { camera, items: std::slice::from_ref(&item), grounds: &[ground], seen };
        canvas.paste(&draw(&view, VIEW, VIEW), left, 0);
    }
    canvas
}

impl From<UpArg> for UpAxis {
    fn from(up: UpArg) -> Self {
        match up {
            UpArg::X => UpAxis::X,
            UpArg::Y => UpAxis::Y,
            UpArg::Z => UpAxis::Z,
        }
    }
}
