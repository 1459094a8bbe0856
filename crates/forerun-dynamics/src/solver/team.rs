//! Team: several threads in one large island, with the bits of one.
//!
//! The lead calls one pass after the other; in each, threads do the blocks of [`Shares`]. No pass waits for who has not come: a thread that has
//! nothing to do in its own share goes on with one that nobody works at, and the lead alone does them all. So teams on one pool, each of which hopes
//! for the threads of the other, cannot block each other. (The end of a team waits until the pool has taken up every invitation.)

use std::cell::UnsafeCell;
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use super::shares::Shares;

/// Looks at what another thread is doing before the processor is given away.
const PATIENCE: u32 = 2000;

/// How far one share is in the running pass.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Progress {
    /// Parts done.
    done: AtomicU32,
    /// Whether a thread works at it.
    taken: AtomicBool,
}

/// What is done to some blocks in a row, by a thread that has the blocks before them in its share behind it.
type Work<'a> = &'a (dyn Fn(Range<usize>) + Sync);

/// The running pass, its lifetime forgotten.
#[derive(Clone, Copy)]
struct Pass {
    shares: *const Shares,
    work: *const (dyn Fn(Range<usize>) + Sync),
}

/// The threads that work at a batch, from the first pass to the last.
pub(crate) struct Team {
    progress: Vec<Progress>,
    /// Even between passes, odd within one; passes are told apart by it.
    epoch: AtomicU32,
    /// Written by the lead between passes, when nobody is inside.
    pass: UnsafeCell<Option<Pass>>,
    /// Threads that may be looking at the running pass.
    inside: AtomicU32,
    over: AtomicBool,
}

// SAFETY: `pass` is the one thing that is not made for threads. The lead writes it while the epoch is even and nobody is inside; others read it after
// they are counted inside and have seen the epoch odd. What it points to outlives the pass: see `Team::run`.
#[allow(unsafe_code, reason = "threads are handed work that lives on the stack of the lead")]
unsafe impl Sync for Team {}

/// Who calls the passes of a team: one thread, one pass at a time.
pub(crate) struct Lead<'a> {
    team: &'a Team,
    /// Stays in its thread.
    here: PhantomData<*const ()>,
}

impl Lead<'_> {
    /// One pass: `work` on all blocks of the shares (as many as the team has threads), those that move a common body in their order. What was written
    /// before the pass is seen in it, and what is written in it after it.
    pub(crate) fn run(&mut self, shares: &Shares, work: Work) {
        self.team.run(shares, work);
    }
}

impl Team {
    /// Has `lead` call passes. Threads of the current pool help as they come, up to `size` with the lead.
    pub(crate) fn gather<R>(size: usize, lead: impl FnOnce(&mut Lead) -> R) -> R {
        // One thread keeps no account of itself: it allocates nothing.
        let counted = if size < 2 { 0 } else { size };
        let team = Team {
            progress: (0..counted).map(|_| Progress::default()).collect(),
            epoch: AtomicU32::new(0),
            pass: UnsafeCell::new(None),
            inside: AtomicU32::new(0),
            over: AtomicBool::new(false),
        };
        if size < 2 {
            return lead(&mut Lead { team: &team, here: PhantomData });
        }
        rayon::in_place_scope(|scope| {
            let team = &team;
            for own in 1..size {
                scope.spawn(move |_| team.help(own));
            }
            // Also when `lead` panics: the others must go home.
            let _over = Over(&team.over);
            lead(&mut Lead { team, here: PhantomData })
        })
    }

    /// How many threads there are at most.
    pub(crate) fn size(&self) -> usize {
        self.progress.len()
    }

    /// See [`Lead::run`], the one who calls it: there is one lead, and it cannot call from within a pass.
    #[allow(unsafe_code, reason = "threads are handed work that lives on the stack of the lead")]
    fn run(&self, shares: &Shares, work: Work) {
        assert_eq!(shares.len(), self.size(), "one share a thread");
        for progress in &self.progress {
            progress.done.store(0, Ordering::Relaxed);
        }
        // SAFETY: only the lifetime is left out. The pointer is followed by threads that are inside, and this function does not return before the last
        // of them has left, nor unwinds before: `Closing` waits as well. (A thread that panics lets go of its share, which another goes on with, some of
        // it twice; the panic leaves the scope, and what was written is thrown away.)
        let work: *const (dyn Fn(Range<usize>) + Sync) =
            unsafe { std::mem::transmute::<Work, &'static (dyn Fn(Range<usize>) + Sync)>(work) };
        // SAFETY: the epoch is even and nobody is inside.
        unsafe { *self.pass.get() = Some(Pass { shares, work }) };
        self.epoch.fetch_add(1, Ordering::SeqCst);
        let _closing = Closing(self);
        let mut patience = Patience::default();
        while !self.all_done(shares) {
            if !self.work_at_some(0) {
                patience.wait();
            }
        }
    }

    fn help(&self, own: usize) {
        let mut patience = Patience::default();
        while !self.over.load(Ordering::Acquire) {
            let epoch = self.epoch.load(Ordering::SeqCst);
            if epoch % 2 == 1 && self.enter(own, epoch) {
                patience = Patience::default();
            } else {
                patience.wait();
            }
        }
    }

    /// Works as long as there is something to do in the pass of this epoch. Whether there was.
    fn enter(&self, own: usize, epoch: u32) -> bool {
        self.inside.fetch_add(1, Ordering::SeqCst);
        let _leave = Leave(&self.inside);
        let mut worked = false;
        // The pass may have ended before the lead could see this thread.
        while self.epoch.load(Ordering::SeqCst) == epoch && self.work_at_some(own) {
            worked = true;
        }
        worked
    }

    fn all_done(&self, shares: &Shares) -> bool {
        (self.progress.iter().enumerate())
            .all(|(k, progress)| progress.done.load(Ordering::Acquire) == shares.parts(k).len() as u32)
    }

    /// Takes the first share that nobody has, its own before the others, and goes on with it as far as it can. Whether anything was done.
    #[allow(unsafe_code, reason = "threads are handed work that lives on the stack of the lead")]
    fn work_at_some(&self, own: usize) -> bool {
        // SAFETY: the caller is the lead in `run`, or inside with the epoch odd: the pass is there and stays until the caller leaves.
        let Some(pass) = (unsafe { *self.pass.get() }) else { return false };
        // SAFETY: as above.
        let (shares, work) = unsafe { (&*pass.shares, &*pass.work) };
        let count = self.size();
        (0..count).map(|k| (own + k) % count).any(|share| self.work_at(share, shares, work))
    }

    fn work_at(&self, share: usize, shares: &Shares, work: Work) -> bool {
        let (progress, parts) = (&self.progress[share], shares.parts(share));
        let finished = progress.done.load(Ordering::Acquire) == parts.len() as u32;
        if finished || progress.taken.swap(true, Ordering::Acquire) {
            return false;
        }
        let _free = Free(&progress.taken);
        // Whoever had the share before has released it, and with it what it had done.
        let from = progress.done.load(Ordering::Relaxed);
        let mut done = from;
        while let Some(part) = parts.get(done as usize) {
            if !self.comes_after(part.after) {
                break;
            }
            if part.start < part.end {
                work(part.start as usize..part.end as usize);
            }
            done += 1;
            progress.done.store(done, Ordering::Release);
        }
        done > from
    }

    /// Waits for so many parts of a share, as long as somebody works at it. Whether they are done.
    fn comes_after(&self, (share, parts): (u32, u32)) -> bool {
        let other = &self.progress[share as usize];
        let mut patience = Patience::default();
        loop {
            if other.done.load(Ordering::Acquire) >= parts {
                return true;
            }
            if !other.taken.load(Ordering::Relaxed) || patience.is_over() {
                return other.done.load(Ordering::Acquire) >= parts;
            }
            patience.wait();
        }
    }
}

/// Waiting for another thread: first at the ready, then giving others the processor.
#[derive(Default)]
struct Patience(u32);

impl Patience {
    fn is_over(&self) -> bool {
        self.0 >= PATIENCE
    }

    fn wait(&mut self) {
        self.0 = self.0.saturating_add(1);
        if self.is_over() {
            std::thread::yield_now();
        } else {
            std::hint::spin_loop();
        }
    }
}

/// Ends the running pass, and waits for those who are still looking at it.
struct Closing<'a>(&'a Team);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.epoch.fetch_add(1, Ordering::SeqCst);
        let mut patience = Patience::default();
        while self.0.inside.load(Ordering::SeqCst) != 0 {
            patience.wait();
        }
    }
}

/// Sets its flag at the end.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

/// Counts one down at the end.
struct Leave<'a>(&'a AtomicU32);

impl Drop for Leave<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Clears its flag at the end.
struct Free<'a>(&'a AtomicBool);

impl Drop for Free<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// Blocks of a random island: which bodies each moves, and the runs, in which no body comes twice.
    fn island(seed: u64, body_count: u32, run_count: usize) -> (Vec<Vec<u32>>, Vec<Range<usize>>) {
        let mut state = seed;
        let mut random = move |below: u32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % u64::from(below)) as u32
        };
        let (mut blocks, mut runs) = (Vec::new(), Vec::new());
        for _ in 0..run_count {
            let start = blocks.len();
            let mut next = 0;
            while next + 12 < body_count {
                let bodies: Vec<u32> = (0..4).map(|k| next + 3 * k + random(3)).collect();
                blocks.push(bodies);
                next += 12 + random(9);
            }
            runs.push(start..blocks.len());
        }
        (blocks, runs)
    }

    fn shares(count: usize, blocks: &[Vec<u32>], runs: &[Range<usize>], body_count: usize) -> Shares {
        let mut shares = Shares::default();
        shares.make(count, runs.iter().cloned(), body_count, |b| blocks[b].iter().copied());
        shares
    }

    #[test]
    fn every_block_is_in_one_share() {
        let (blocks, runs) = island(1, 300, 20);
        let shares = shares(3, &blocks, &runs, 300);
        let of = |share| shares.parts(share).iter().flat_map(|part| part.start..part.end);
        let mut all: Vec<u32> = (0..3).flat_map(of).collect();
        all.sort_unstable();
        assert_eq!(all, (0..blocks.len() as u32).collect::<Vec<_>>());
    }

    /// Each body notes who moved it, in order: the notes must be those of one thread.
    #[test]
    fn blocks_that_move_a_common_body_come_in_their_order() {
        for (seed, threads) in [(1, 1), (2, 2), (3, 3), (4, 4), (5, 2), (6, 4)] {
            let (blocks, runs) = island(seed, 400, 30);
            let shares = shares(4, &blocks, &runs, 400);
            let notes: Vec<Mutex<Vec<usize>>> = (0..400).map(|_| Mutex::default()).collect();
            let pass = |team: &mut Lead, pass: usize| {
                team.run(&shares, &|range| {
                    for block in range {
                        for &body in &blocks[block] {
                            notes[body as usize].lock().unwrap().push(pass * blocks.len() + block);
                        }
                    }
                });
            };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Team::gather(4, |team| (0..20).for_each(|k| pass(team, k))));
            for (body, notes) in notes.into_iter().enumerate() {
                let notes = notes.into_inner().unwrap();
                assert!(notes.is_sorted(), "seed {seed}, body {body}: {notes:?}");
                let each = blocks.iter().filter(|b| b.contains(&(body as u32))).count();
                assert_eq!(notes.len(), 20 * each);
            }
        }
    }

    /// Two teams on two threads: each waits for help that is busy leading the other.
    #[test]
    fn teams_side_by_side_do_not_wait_for_each_other() {
        let (blocks, runs) = island(7, 200, 10);
        let shares = shares(2, &blocks, &runs, 200);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let count = AtomicU32::new(0);
        let lead = || {
            let work = |range: Range<usize>| {
                count.fetch_add(range.len() as u32, Ordering::Relaxed);
            };
            Team::gather(2, |team| (0..50).for_each(|_| team.run(&shares, &work)));
        };
        pool.install(|| rayon::join(lead, lead));
        assert_eq!(count.into_inner() as usize, 2 * 50 * blocks.len());
    }
}
