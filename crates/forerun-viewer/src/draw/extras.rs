//! Extras: what the hands show over the bodies while they aim, drag and throw.

use forerun::{Pose, Shape, Vec3};

/// What is shown besides the bodies.
#[derive(Clone, Debug, Default)]
pub struct Extras {
    /// What would come of a throw, as far as it is computed.
    pub preview: Vec<PreviewTrack>,
    /// The thing at hand, before it is thrown: transparent.
    pub held: Option<(Shape, Pose)>,
    /// Where a throw or a push goes, from its beginning to its end. Metres.
    pub aim: Option<[Vec3; 2]>,
    /// The spring that drags a body, from the body to the hand. Metres.
    pub grab: Option<[Vec3; 2]>,
    /// The body that a click would pick.
    pub pointed: Option<forerun::BodyId>,
}

/// The path of a body that is not there yet, or that goes another way than it would without what is aimed.
#[derive(Clone, Debug)]
pub struct PreviewTrack {
    /// What is drawn, transparent, at the last pose.
    pub shape: Shape,
    /// One a frame.
    pub poses: Vec<Pose>,
}
