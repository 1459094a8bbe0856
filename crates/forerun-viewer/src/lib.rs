//! The viewer: watch, throw, drag, scrub and look ahead, in a window or in a web page.
//!
//! It holds no physics. A [`session`] plays a scene through a driver of [`forerun`], and every hand laid on a body is a command; the rest is
//! drawing ([`draw`]), the mouse ([`hands`]) and panels ([`panels`]). The same code runs natively and as WebAssembly: what differs is in [`host`].
//!
//! Promise: nothing here waits for physics. What takes long (reading a scene, baking its meshes, looking into a frame) is done elsewhere
//! and comes when it is there.

pub mod actions;
pub mod camera;
pub mod capture;
pub mod desk;
pub mod draw;
pub mod hands;
pub mod host;
pub mod input;
pub mod keeper;
pub mod news;
#[cfg(target_arch = "wasm32")]
pub mod page;
pub mod panels;
pub mod report;
pub mod series;
pub mod session;
pub mod settings;
pub mod tessellate;
pub mod view;
pub mod viewer;
#[cfg(not(target_arch = "wasm32"))]
pub mod window;

pub use host::SceneSource;
pub use viewer::Viewer;
#[cfg(not(target_arch = "wasm32"))]
pub use window::{NoWindow, Screenshot, WindowOptions, open};
