//! Writing of files beside the run, in order, by a thread of its own.
//!
//! What is to be written is copied when it is handed over, so that the world may go on. At most one job waits while another is written: then
//! the run waits, and memory stays bounded. Files are complete before the next one is begun; the first failure ends the writing and is
//! returned by the next call.

use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, channel, sync_channel};
use std::thread::{Builder, JoinHandle};

use super::ObserveError;

/// Jobs that wait while another one is done.
const WAITING: usize = 1;

type Job<T> = Box<dyn FnOnce() -> Result<T, ObserveError> + Send>;

/// A thread that writes files one after the other; each job tells what it wrote.
#[derive(Debug)]
pub(super) struct Background<T> {
    worker: Option<Worker<T>>,
    /// Jobs handed over, without an answer yet.
    n_open: usize,
    written: Vec<T>,
}

#[derive(Debug)]
struct Worker<T> {
    jobs: SyncSender<Job<T>>,
    answers: Receiver<Result<T, ObserveError>>,
    thread: JoinHandle<()>,
}

impl<T: Send + 'static> Background<T> {
    /// No thread before the first job.
    pub fn new() -> Self {
        Self {
            worker: None,
            n_open: 0,
            written: Vec::new(),
        }
    }

    /// Hands a job over; waits while another one waits already.
    ///
    /// # Errors
    ///
    /// That of an earlier job; where no thread can be started the job is done at once, and the error may be its own.
    pub fn put(
        &mut self,
        job: impl FnOnce() -> Result<T, ObserveError> + Send + 'static,
    ) -> Result<(), ObserveError> {
        self.collect()?;
        if self.worker.is_none() {
            self.worker = Worker::start().ok();
        }
        let Some(worker) = &self.worker else {
            self.written.push(job()?);
            return Ok(());
        };
        match worker.jobs.send(Box::new(job)) {
            Ok(()) => {
                self.n_open += 1;
                Ok(())
            }
            // the thread ended with the failure of an earlier job
            Err(_) => self.wait(),
        }
    }

    /// Answers that have come.
    fn collect(&mut self) -> Result<(), ObserveError> {
        while let (Some(worker), true) = (&self.worker, 0 < self.n_open) {
            match worker.answers.try_recv() {
                Ok(answer) => self.take(answer)?,
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return Err(self.stopped()),
            }
        }
        Ok(())
    }

    /// Waits until everything handed over is written.
    ///
    /// # Errors
    ///
    /// The first failure of a job.
    pub fn wait(&mut self) -> Result<(), ObserveError> {
        while let (Some(worker), true) = (&self.worker, 0 < self.n_open) {
            match worker.answers.recv() {
                Ok(answer) => self.take(answer)?,
                Err(_) => return Err(self.stopped()),
            }
        }
        Ok(())
    }

    /// What was written since the last call.
    ///
    /// # Errors
    ///
    /// The first failure of a job.
    pub fn take_written(&mut self) -> Result<Vec<T>, ObserveError> {
        self.collect()?;
        Ok(std::mem::take(&mut self.written))
    }

    fn take(&mut self, answer: Result<T, ObserveError>) -> Result<(), ObserveError> {
        self.n_open -= 1;
        match answer {
            Ok(written) => {
                self.written.push(written);
                Ok(())
            }
            Err(error) => {
                self.forget();
                Err(error)
            }
        }
    }

    /// Failure of the thread itself.
    fn stopped(&mut self) -> ObserveError {
        self.forget();
        ObserveError::Write {
            path: "the files of this moment".to_owned(),
            source: std::io::Error::other("the thread that writes them has ended"),
        }
    }

    /// Later jobs begin with a new thread.
    fn forget(&mut self) {
        self.worker = None;
        self.n_open = 0;
    }
}

impl<T: Send + 'static> Worker<T> {
    fn start() -> std::io::Result<Self> {
        let (jobs, waiting) = sync_channel::<Job<T>>(WAITING);
        let (answer, answers) = channel();
        let thread = Builder::new().name("files".to_owned()).spawn(move || {
            for job in waiting {
                let done = job();
                let has_failed = done.is_err();
                if answer.send(done).is_err() || has_failed {
                    break;
                }
            }
        })?;
        Ok(Self {
            jobs,
            answers,
            thread,
        })
    }
}

impl<T> Drop for Background<T> {
    /// Everything handed over is written before the process may end.
    fn drop(&mut self) {
        if let Some(Worker { jobs, thread, .. }) = self.worker.take() {
            drop(jobs);
            // a panic of the thread was reported by it
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop")]

    use super::*;
    use std::sync::{Arc, Mutex};

    fn failure(name: &str) -> ObserveError {
        ObserveError::Write {
            path: name.to_owned(),
            source: std::io::Error::other("no space"),
        }
    }

    #[test]
    fn jobs_are_done_in_order_and_all_before_the_end() {
        let done = Arc::new(Mutex::new(Vec::new()));
        let mut background = Background::new();
        for number in 0..20 {
            let done = Arc::clone(&done);
            let job = move || {
                done.lock().unwrap().push(number);
                Ok(number)
            };
            background.put(job).unwrap();
        }
        background.wait().unwrap();
        assert_eq!(background.take_written().unwrap(), Vec::from_iter(0..20));
        let last = Arc::clone(&done);
        let job = move || {
            std::thread::sleep(std::time::Duration::from_millis(20));
            last.lock().unwrap().push(20);
            Ok(20)
        };
        background.put(job).unwrap();
        drop(background);
        assert_eq!(*done.lock().unwrap(), Vec::from_iter(0..=20));
    }

    #[test]
    fn a_failure_is_told_once() {
        let mut background = Background::new();
        background.put(|| Ok(1)).unwrap();
        background.put(|| Err(failure("second"))).unwrap();
        let mut told = Vec::new();
        told.extend(background.wait().err());
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].to_string().contains("second"));
        // space was freed
        background.put(|| Ok(5)).unwrap();
        background.wait().unwrap();
        assert_eq!(background.take_written().unwrap(), [1, 5]);
    }
}
