//! Mesh files in formats of several parts, and damaged files of every format.

mod damage;
mod gltf;
mod ply;
mod writers;
