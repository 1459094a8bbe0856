//! The same bits in whatever instructions the kernels are compiled.

mod common;

use common::{heap_of_rings, pyramid, rain, run, with_material, world_of};
use forerun_dynamics::BodyState;
use forerun_dynamics::lanes::{InstructionSet, limit_to};

#[test]
fn every_instruction_set_gives_the_same_states() {
    // Balls, boxes and capsules, some of which bounce, in a heap that the load pass cannot carry; a pyramid, which it can; and meshes.
    let mut defs = rain(80, 5);
    for def in defs.iter_mut().step_by(3) {
        *def = with_material(def.clone(), 0.4, 0.6);
    }
    for scene in [defs, pyramid(12), heap_of_rings(24)] {
        let mut reference = None;
        for set in InstructionSet::ALL {
            if limit_to(set) != set {
                continue;
            }
            let mut world = world_of(&scene);
            run(&mut world, 150);
            let bits: Vec<[u32; 14]> = world.states().iter().map(BodyState::bits).collect();
            assert!(*reference.get_or_insert_with(|| bits.clone()) == bits, "{set} differs from portable");
        }
    }
    limit_to(InstructionSet::Avx512);
}
