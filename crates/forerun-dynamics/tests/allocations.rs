//! A steady step works in the memory of the step before.
#![allow(unsafe_code, reason = "to count allocations is to be the allocator")]

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use common::{heap_of_rings, pyramid, run, world_of};
use forerun_dynamics::BodyDef;
use forerun_geometry::shape::Sphere;
use forerun_geometry::{Shape, Vec3};

thread_local! {
    static COUNT: Cell<u32> = const { Cell::new(0) };
}

/// The system's allocator, counting.
struct Counting;

// SAFETY: it does what the system's does.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        unsafe { System.dealloc(place, layout) }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        unsafe { System.realloc(place, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_steady_step_allocates_nothing() {
    for rest_seconds in [0.0, 10.0] {
        let mut world = world_of(&pyramid(15));
        world.environment.settings.rest_seconds = rest_seconds;
        run(&mut world, 20);
        let before = COUNT.get();
        run(&mut world, 50);
        assert_eq!(COUNT.get() - before, 0, "rest after {rest_seconds} s");
    }
}

#[test]
fn a_steady_step_where_some_rest_and_others_move_allocates_nothing() {
    // A pyramid at rest, and beside it a ball that rolls on for ever.
    let mut defs = pyramid(6);
    let mut ball = BodyDef::new(Shape::Sphere(Sphere { radius: 0.5 })).at(Vec3::new(-20.0, 0.5, 0.0));
    ball.velocity = Vec3::new(0.0, 0.0, 3.0);
    ball.angular_velocity = Vec3::new(6.0, 0.0, 0.0);
    defs.push(ball);
    let mut world = world_of(&defs);
    run(&mut world, 200);
    let full = world.environment.settings.rest_frames();
    assert!(world.states()[1].rest > full && world.states()[defs.len() - 1].rest == 0);
    let before = COUNT.get();
    run(&mut world, 50);
    assert_eq!(COUNT.get() - before, 0);
}

#[test]
fn a_steady_step_of_meshes_allocates_nothing() {
    // In a pool of its own: to hand several islands to a pool from outside takes memory for its queue.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let count = pool.install(|| {
        let mut world = world_of(&heap_of_rings(16));
        world.environment.settings.rest_seconds = 0.0;
        run(&mut world, 600);
        let before = COUNT.get();
        run(&mut world, 50);
        COUNT.get() - before
    });
    assert_eq!(count, 0);
}
