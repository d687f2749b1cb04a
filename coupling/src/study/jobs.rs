//! Execution of independent jobs, as many at once as cores and memory allow.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Resources for concurrent runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Means {
    /// Runs at once, one thread each.
    pub workers: usize,
    /// Largest sum of the estimated memory of concurrent runs; bytes. A run that needs more runs alone.
    pub memory: u64,
}

/// Progress of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Completed runs.
    pub ended: usize,
    /// Total number.
    pub all: usize,
}

/// What takes memory while it is executed.
pub trait Job: Sync {
    /// Estimated memory; bytes.
    fn memory(&self) -> u64;
}

/// Function that executes one job; returns whether it is complete.
pub type Execute<'a, J, E> = dyn Fn(&J) -> Result<bool, E> + Sync + 'a;

/// Executes jobs, those that fit the free memory first, in their order; `stop` ends it after the active ones. `tell` is called with the
/// number of jobs that are complete, at the start and after each. Returns whether all are complete.
///
/// # Errors
///
/// The first error of a job, after the active ones have ended.
pub fn run_all<J: Job, E: Send>(
    waiting: Vec<&J>,
    means: Means,
    stop: &AtomicBool,
    execute: &Execute<J, E>,
    tell: &(dyn Fn(usize) + Sync),
) -> Result<bool, E> {
    let all = waiting.len();
    let queue = Queue {
        state: Mutex::new(State {
            ended: 0,
            waiting,
            used: 0,
            under_way: 0,
            error: None,
        }),
        changed: Condvar::new(),
        memory: means.memory,
    };
    tell(0);
    std::thread::scope(|scope| {
        for _ in 0..means.workers.max(1) {
            scope.spawn(|| {
                while let Some(job) = queue.next(stop) {
                    if let Some(ended) = queue.done(job, execute(job)) {
                        tell(ended);
                    }
                }
            });
        }
    });
    let state = queue
        .state
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    match state.error {
        Some(error) => Err(error),
        None => Ok(state.ended == all),
    }
}

/// Waiting jobs, and the memory of active ones.
struct Queue<'a, J, E> {
    state: Mutex<State<'a, J, E>>,
    changed: Condvar,
    memory: u64,
}

struct State<'a, J, E> {
    waiting: Vec<&'a J>,
    used: u64,
    under_way: usize,
    ended: usize,
    error: Option<E>,
}

impl<'a, J: Job, E> Queue<'a, J, E> {
    fn lock(&self) -> MutexGuard<'_, State<'a, J, E>> {
        // a worker that panicked leaves valid numbers
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The first job with sufficient memory, in their order; waits for one.
    fn next(&self, stop: &AtomicBool) -> Option<&'a J> {
        let mut state = self.lock();
        loop {
            if stop.load(Ordering::Relaxed) || state.error.is_some() || state.waiting.is_empty() {
                return None;
            }
            let is_alone = state.under_way == 0;
            let fits = |job: &&J| state.used + job.memory() <= self.memory;
            let found = state.waiting.iter().position(fits);
            if let Some(k) = found.or(is_alone.then_some(0)) {
                let job = state.waiting.remove(k);
                state.used += job.memory();
                state.under_way += 1;
                return Some(job);
            }
            state = self
                .changed
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Releases the memory of a job; returns the number of completed jobs, if it is complete.
    fn done(&self, job: &J, made: Result<bool, E>) -> Option<usize> {
        let mut state = self.lock();
        state.used -= job.memory();
        state.under_way -= 1;
        self.changed.notify_all();
        match made {
            Ok(true) => {
                state.ended += 1;
                Some(state.ended)
            }
            Ok(false) => None,
            Err(error) => {
                state.error.get_or_insert(error);
                None
            }
        }
    }
}
