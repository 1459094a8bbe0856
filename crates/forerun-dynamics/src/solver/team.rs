//! Team: several threads in one large island, with the bits of one.
//!
//! Gauss-Seidel gives the same result whoever does the work, as long as blocks that move a common body come in their order. A run (one level, one
//! colour) moves no body twice; [`Shares`] cuts every run into as many parts as there are threads. Contacts are ordered by body, so that a share
//! is a region of the island, and waits for another one only where the two meet: no barrier stands between runs, only between passes.
//!
//! Nobody is waited for who has not come: a thread that has nothing to do in its own share goes on with one that nobody works at, and one thread alone
//! does them all.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Blocks of a share that are done in one go: few enough that a neighbour does not wait long, many enough to be worth the call.
const BLOCKS_PER_PART: u32 = 8;
/// Looks at what another thread is doing before the processor is given away.
const PATIENCE: u32 = 2000;
/// No share has touched the body yet.
const NOBODY: (u32, u32) = (u32::MAX, 0);

/// Some blocks in a row of one share, and what has to be done before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    start: u32,
    end: u32,
    /// A share, and how many of its parts have to be done before.
    after: (u32, u32),
}

/// Who does which blocks of an island, and who waits for whom.
#[derive(Debug, Default)]
pub(crate) struct Shares {
    shares: Vec<Vec<Part>>,
    /// Per body, while they are made: the share that moved it last, and how many parts that had then.
    last: Vec<(u32, u32)>,
    /// Per share: whether its last part may grow.
    open: Vec<bool>,
    /// Per share and other share: how many of the other's parts it is known to come after.
    known: Vec<u32>,
}

impl Shares {
    /// Shares out the blocks of `runs`, which follow each other. `bodies` tells which bodies (below `body_count`) a block moves.
    pub(crate) fn make<I: Iterator<Item = u32> + Clone>(
        &mut self,
        count: usize,
        runs: &[Range<usize>],
        body_count: usize,
        bodies: impl Fn(usize) -> I,
    ) {
        self.shares.resize(count, Vec::new());
        self.shares.iter_mut().for_each(Vec::clear);
        self.last.clear();
        self.last.resize(body_count, NOBODY);
        self.open.clear();
        self.open.resize(count, false);
        self.known.clear();
        self.known.resize(count * count, 0);
        for run in runs {
            for block in run.clone() {
                let share = (block - run.start) * count / run.len();
                self.add(share, block as u32, bodies(block));
            }
        }
    }

    /// How many shares there are.
    pub(crate) fn len(&self) -> usize {
        self.shares.len()
    }

    /// The blocks of each share, in its order.
    pub(crate) fn blocks(&self, share: usize) -> impl Iterator<Item = usize> + '_ {
        self.shares[share].iter().flat_map(|part| part.start as usize..part.end as usize)
    }

    fn add(&mut self, share: usize, block: u32, bodies: impl Iterator<Item = u32> + Clone) {
        let count = self.shares.len();
        let mut waits = false;
        for body in bodies.clone() {
            let (other, parts) = self.last[body as usize];
            if other == NOBODY.0 || other as usize == share {
                continue;
            }
            let known = &mut self.known[share * count + other as usize];
            if parts > *known {
                *known = parts;
                waits = true;
                // What is waited for ends where it is: what follows may wait for this share.
                self.open[other as usize] = false;
                let start = Part { start: block, end: block, after: (other, parts) };
                self.shares[share].push(start);
            }
        }
        if waits {
            self.open[share] = true;
        }
        let parts = &mut self.shares[share];
        let grows = self.open[share]
            && parts.last().is_some_and(|p| p.end == block && p.end - p.start < BLOCKS_PER_PART);
        if grows {
            parts.last_mut().expect("it was looked at").end = block + 1;
        } else {
            parts.push(Part { start: block, end: block + 1, after: (share as u32, 0) });
            self.open[share] = true;
        }
        let here = (share as u32, parts.len() as u32);
        for body in bodies {
            self.last[body as usize] = here;
        }
    }
}

/// How far one share is in the running pass.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Progress {
    /// Parts done.
    done: AtomicU32,
    /// Whether a thread works at it.
    taken: AtomicBool,
}

/// The threads that work at an island, from the first pass to the last.
pub(crate) struct Team<'a, W> {
    shares: &'a Shares,
    progress: Vec<Progress>,
    /// Even between passes, odd within one; passes are told apart by it.
    epoch: AtomicU32,
    /// What the running pass does.
    pass: AtomicU32,
    /// Threads that may be looking at the running pass.
    inside: AtomicU32,
    over: AtomicBool,
    work: W,
}

impl<W: Fn(u32, usize, Range<usize>) + Sync> Team<'_, W> {
    /// Has `lead` call passes; each does `work(pass, share, blocks)` for all blocks, those that move a common body in their order. Threads of the
    /// current pool help as they come. What was written in one pass is seen in the next, and by `lead` after it.
    pub(crate) fn gather<R>(shares: &Shares, work: W, lead: impl FnOnce(&Team<W>) -> R) -> R {
        let team = Team {
            shares,
            progress: (0..shares.len()).map(|_| Progress::default()).collect(),
            epoch: AtomicU32::new(0),
            pass: AtomicU32::new(0),
            inside: AtomicU32::new(0),
            over: AtomicBool::new(false),
            work,
        };
        rayon::in_place_scope(|scope| {
            let team = &team;
            for own in 1..shares.len().min(rayon::current_num_threads()) {
                scope.spawn(move |_| team.help(own));
            }
            // Also when `lead` panics: the others must go home.
            let _over = Over(&team.over);
            lead(team)
        })
    }

    /// One pass over all blocks. To be called by the lead alone.
    pub(crate) fn run(&self, pass: u32) {
        self.pass.store(pass, Ordering::Relaxed);
        for progress in &self.progress {
            progress.done.store(0, Ordering::Relaxed);
        }
        self.epoch.fetch_add(1, Ordering::SeqCst);
        let mut patience = Patience::default();
        while !self.all_done() {
            if !self.work_at_some(0) {
                patience.wait();
            }
        }
        self.epoch.fetch_add(1, Ordering::SeqCst);
        let mut patience = Patience::default();
        while self.inside.load(Ordering::SeqCst) != 0 {
            patience.wait();
        }
    }

    fn help(&self, own: usize) {
        let mut patience = Patience::default();
        while !self.over.load(Ordering::Acquire) {
            let epoch = self.epoch.load(Ordering::SeqCst);
            if epoch % 2 == 0 {
                patience.wait();
                continue;
            }
            if self.enter(own, epoch) {
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

    fn all_done(&self) -> bool {
        (self.progress.iter().zip(&self.shares.shares))
            .all(|(progress, parts)| progress.done.load(Ordering::Acquire) == parts.len() as u32)
    }

    /// Takes the first share that nobody has, its own before the others, and goes on with it as far as it can. Whether anything was done.
    fn work_at_some(&self, own: usize) -> bool {
        let count = self.progress.len();
        (0..count).map(|k| (own + k) % count).any(|share| self.work_at(share))
    }

    fn work_at(&self, share: usize) -> bool {
        let (progress, parts) = (&self.progress[share], &self.shares.shares[share]);
        let finished = || progress.done.load(Ordering::Acquire) == parts.len() as u32;
        if finished() || progress.taken.swap(true, Ordering::Acquire) {
            return false;
        }
        let _free = Free(&progress.taken);
        let pass = self.pass.load(Ordering::Relaxed);
        // Whoever had the share before has released it, and with it what it had done.
        let from = progress.done.load(Ordering::Relaxed);
        let mut done = from;
        while let Some(part) = parts.get(done as usize) {
            if !self.comes_after(part.after) {
                break;
            }
            if part.start < part.end {
                (self.work)(pass, share, part.start as usize..part.end as usize);
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
        shares.make(count, runs, body_count, |b| blocks[b].iter().copied());
        shares
    }

    #[test]
    fn every_block_is_in_one_share() {
        let (blocks, runs) = island(1, 300, 20);
        let shares = shares(3, &blocks, &runs, 300);
        let mut all: Vec<usize> = (0..3).flat_map(|s| shares.blocks(s).collect::<Vec<_>>()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..blocks.len()).collect::<Vec<_>>());
        assert!((0..3).all(|s| shares.blocks(s).is_sorted()));
    }

    /// Each body notes who moved it, in order: the notes must be those of one thread.
    #[test]
    fn blocks_that_move_a_common_body_come_in_their_order() {
        for (seed, threads) in [(1, 1), (2, 2), (3, 3), (4, 4), (5, 2), (6, 4)] {
            let (blocks, runs) = island(seed, 400, 30);
            let shares = shares(4, &blocks, &runs, 400);
            let notes: Vec<Mutex<Vec<usize>>> = (0..400).map(|_| Mutex::default()).collect();
            let work = |pass: u32, _: usize, range: Range<usize>| {
                for block in range {
                    for &body in &blocks[block] {
                        notes[body as usize].lock().unwrap().push(pass as usize * blocks.len() + block);
                    }
                }
            };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Team::gather(&shares, work, |team| (0..20).for_each(|pass| team.run(pass))));
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
            let work = |_: u32, _: usize, range: Range<usize>| {
                count.fetch_add(range.len() as u32, Ordering::Relaxed);
            };
            Team::gather(&shares, work, |team| (0..50).for_each(|pass| team.run(pass)));
        };
        pool.install(|| rayon::join(lead, lead));
        assert_eq!(count.into_inner() as usize, 2 * 50 * blocks.len());
    }
}
