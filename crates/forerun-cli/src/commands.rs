//! Commands: one room for each word after `forerun`.

pub(crate) mod bench;
pub(crate) mod check;
pub(crate) mod experiment;
pub(crate) mod mesh;
pub(crate) mod render;
pub(crate) mod replay;
pub(crate) mod run;
pub(crate) mod scenes;
pub(crate) mod soak;
pub(crate) mod validate;
pub(crate) mod view;
