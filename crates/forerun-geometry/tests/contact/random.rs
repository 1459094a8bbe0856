//! Properties of random pairs.
