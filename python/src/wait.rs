//! Waiting for other threads without holding the lock of the interpreter, interrupted by signals.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// Wall time between two looks for signals.
const INTERVAL: Duration = Duration::from_millis(50);
/// Stack of a thread that does the work of a main thread; bytes.
pub const STACK: usize = 8 << 20;

/// Waits for a reply. A signal ends the wait at once, or with `stop`, which it sets, when the reply to that has come.
pub fn for_reply<T: Send>(
    py: Python<'_>,
    mut reply: Receiver<T>,
    stop: Option<&AtomicBool>,
) -> PyResult<T> {
    loop {
        let received;
        (received, reply) = py.detach(move || (reply.recv_timeout(INTERVAL), reply));
        match received {
            Ok(value) => return Ok(value),
            Err(RecvTimeoutError::Disconnected) => return Err(lost()),
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(signal) = py.check_signals() {
            if let Some(stop) = stop {
                stop.store(true, Ordering::Relaxed);
                py.detach(move || reply.recv().ok());
            }
            return Err(signal);
        }
    }
}

/// Result of some work in a thread of its own; a signal abandons it.
pub fn for_work<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (answer, reply) = channel();
    let thread = thread::Builder::new().stack_size(STACK);
    // nobody waits for the answer after a signal
    thread.spawn(move || drop(answer.send(work())))?;
    for_reply(py, reply, None)
}

/// A thread ended without an answer: it panicked.
fn lost() -> PyErr {
    let what =
        "riprap failed by an error of its own; the message above says where, please report it";
    pyo3::exceptions::PyRuntimeError::new_err(what)
}
