//! Simulation states over time: tracks, commands, incremental re-simulation, sampling.
