//! Arguments of the commands that look at meshes and draw.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::{SCENE_HELP, fps, number_in, threads};

/// Largest side of a picture. Pixels.
const SIDE_MAX: u32 = 4096;

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum UpArg {
    /// x is up
    X,
    /// y is up, as in glTF
    Y,
    /// z is up, as in most programs that construct
    Z,
}

#[derive(Debug, Args)]
pub(crate) struct MeshArgs {
    /// A mesh: .obj, .stl, .ply, .gltf or .glb
    pub(crate) file: PathBuf,
    /// Factor from the file's unit of length to metres: 0.001 for millimetres
    #[arg(long, default_value = "1", value_parser = scale, allow_negative_numbers = true)]
    pub(crate) scale: f32,
    /// Axis of the file that points up
    #[arg(long, value_enum, default_value = "y")]
    pub(crate) up: UpArg,
    /// Wished edge of the field's cells in metres [default: an eighth of the smallest thickness or narrowest gap, larger where memory demands it]
    #[arg(long, value_name = "METRES", value_parser = scale, allow_negative_numbers = true)]
    pub(crate) cell: Option<f32>,
    /// Density in kg/m³, for mass and inertia
    #[arg(long, default_value = "1000", value_parser = scale, allow_negative_numbers = true)]
    pub(crate) density: f32,
    /// Draw the mesh from two sides
    #[arg(long, value_name = "FILE.png")]
    pub(crate) picture: Option<PathBuf>,
    /// Draw the field in three planes through the centre of mass, beside the true section
    #[arg(long, value_name = "FILE.png")]
    pub(crate) slice: Option<PathBuf>,
    /// Bake anew and keep nothing (fields are kept in FORERUN_CACHE_DIR, else in the user's cache folder)
    #[arg(long)]
    pub(crate) no_cache: bool,
    /// Print the result as JSON and nothing else
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RenderArgs {
    #[arg(help = SCENE_HELP)]
    pub(crate) scene: String,
    /// Simulated time of the picture, or end of the film, in seconds [default: the scene's length]
    #[arg(long, value_name = "SECONDS", value_parser = time, allow_negative_numbers = true)]
    pub(crate) time: Option<f64>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub(crate) size: [u32; 2],
    /// The PNG file to write
    #[arg(short, long, value_name = "FILE.png")]
    pub(crate) output: Option<PathBuf>,
    /// Folder for a picture of every moment from the start, numbered from 00000.png; the camera stays where it is
    #[arg(long, value_name = "DIR")]
    pub(crate) film: Option<PathBuf>,
    /// Pictures of the film per simulated second
    #[arg(long, default_value = "30", value_parser = fps, allow_negative_numbers = true)]
    pub(crate) fps: f64,
    /// Threads of the physics [default: one per core]
    #[arg(long, value_parser = threads())]
    pub(crate) threads: Option<u16>,
}

fn scale(text: &str) -> Result<f32, String> {
    number_in(text, 1e-9, 1e9).map(|number| number as f32)
}

fn time(text: &str) -> Result<f64, String> {
    number_in(text, 0.0, 86_400.0)
}

/// `forerun view`.
#[derive(Debug, Default, Args)]
pub(crate) struct ViewArgs {
    #[arg(help = format!("{SCENE_HELP} [default: dominoes]"))]
    pub(crate) scene: Option<String>,
    /// Width and height of the window; without it the window is as large as the screen
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Display time to begin at, in seconds
    #[arg(long, value_name = "SECONDS", value_parser = time, allow_negative_numbers = true)]
    pub(crate) time: Option<f64>,
    /// Begin with display time standing still
    #[arg(long)]
    pub(crate) paused: bool,
    /// Keep a picture of the window in this file and end
    #[arg(long, value_name = "FILE.png")]
    pub(crate) screenshot: Option<PathBuf>,
    /// When that picture is taken, in seconds after the scene began
    #[arg(long, value_name = "SECONDS", default_value = "2", value_parser = time, allow_negative_numbers = true, requires = "screenshot")]
    pub(crate) after: f64,
    /// Keep the state of the viewer in this file, as JSON, for scripts
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).and_then(|(width, height)| {
        let side = |text: &str| text.parse().ok().filter(|side| (1..=SIDE_MAX).contains(side));
        Some([side(width)?, side(height)?])
    });
    sides.ok_or_else(|| format!("give width and height like 1280x720, each from 1 to {SIDE_MAX}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_or_refused_with_an_example() {
        assert_eq!(size("640x360"), Ok([640, 360]));
        for bad in ["", "640", "640x", "0x9", "9999x9", "-1x5", "axb"] {
            assert!(size(bad).unwrap_err().contains("1280x720"), "{bad}");
        }
    }
}
