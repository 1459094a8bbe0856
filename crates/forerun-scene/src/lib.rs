//! Scene files (TOML, JSON) and the built-in scenes.
