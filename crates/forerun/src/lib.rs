//! Rigid-body physics that runs ahead of the display.
