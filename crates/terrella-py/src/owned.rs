//! Objects that hold a device, and work in one process only.

use crate::errors::Error;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::Mutex;

/// A renderer, used by one thread at a time, in the process that created it. Drivers do not survive `fork`: the child lacks their threads and would
/// wait for them forever.
pub struct Owned<T> {
    /// `None` only while it is dropped.
    value: Option<Mutex<T>>,
    process: u32,
}

impl<T: Send> Owned<T> {
    pub fn new(value: T) -> Self {
        Self {
            value: Some(Mutex::new(value)),
            process: std::process::id(),
        }
    }

    /// Runs long work on the renderer without the interpreter, so that a thread that waits here blocks no other.
    pub fn with<R: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut T) -> Result<R, PyErr> + Send,
    ) -> PyResult<R> {
        let here = std::process::id();
        if here != self.process {
            return Err(PyRuntimeError::new_err(format!(
                "a renderer of process {} is used in process {here}, its fork; make it in the process that draws, or start workers with \
                 multiprocessing.get_context(\"spawn\")",
                self.process
            )));
        }
        py.detach(|| match self.value.as_ref().map(Mutex::lock) {
            Some(Ok(mut value)) => work(&mut value),
            _ => Err(Error::new_err(
                "this renderer broke down in an earlier call; make a new one",
            )),
        })
    }
}

impl<T> Drop for Owned<T> {
    fn drop(&mut self) {
        // In a forked process it is leaked: its driver would wait for threads that do not exist.
        if std::process::id() != self.process {
            std::mem::forget(self.value.take());
        }
    }
}
