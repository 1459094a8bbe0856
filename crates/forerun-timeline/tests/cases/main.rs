//! The cases of the timeline, small: what an edit costs, where it ends, in which order commands act, what a seek shows, how far a change
//! reaches. Everything that is changed is compared with a full simulation, bit for bit.

mod containment;
mod cost;
mod cutoff;
mod lab;
mod order;
mod scrub;
