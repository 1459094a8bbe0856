//! Overlap meter: how deep bodies are in one another, from poses alone.
//!
//! Velocities, gravity and the margin of the contact search are left out, so what the solver expects or allows plays no part.

use forerun::dynamics::{Environment, Member, World, bounds, broad_phase, narrow_phase};
use forerun::{BodyId, BodyState, Vec3};

/// The deepest overlap of two bodies of the world. Metres, 0 when nothing overlaps.
pub(crate) fn deepest_m(world: &World) -> f32 {
    let still = Environment {
        gravity: Vec3::ZERO,
        settings: forerun::StepSettings { contact_margin_m: 0.0, ..world.environment.settings },
    };
    let states = world.states().iter().map(|state| BodyState {
        velocity: Vec3::ZERO,
        angular_velocity: Vec3::ZERO,
        ..*state
    });
    let members: Vec<Member> = (world.bodies().iter().zip(states).enumerate())
        .map(|(i, (body, state))| Member { id: BodyId(i as u32), body, state })
        .collect();
    let swept: Vec<broad_phase::Bound> = members
        .iter()
        .map(|m| broad_phase::Bound {
            aabb: bounds::swept_bound(m.body, &m.state, &still),
            dynamic: m.body.is_dynamic(),
        })
        .collect();
    let contacts = narrow_phase::find_contacts(&members, &broad_phase::overlapping_pairs(&swept), &still);
    contacts
        .iter()
        .flat_map(|contact| &contact.manifold.points[..contact.manifold.count as usize])
        .map(|point| -point.separation)
        .fold(0.0, f32::max)
}
