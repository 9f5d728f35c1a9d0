//! Warnings of the library as records of Python's `logging`, under the logger `terrella`.

use log::{Level, LevelFilter, Log, Metadata, Record};
use pyo3::prelude::*;

/// Of a process: gives warnings and errors of our crates to Python.
struct PythonLogger;

impl Log for PythonLogger {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.level() <= Level::Warn && metadata.target().starts_with("terrella")
    }

    fn log(&self, record: &Record<'_>) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let name = match record.level() {
            Level::Error => "error",
            _ => "warning",
        };
        // At the interpreter's end there is nobody to tell.
        let _ = Python::try_attach(|py| -> PyResult<()> {
            let logger = py
                .import("logging")?
                .call_method1("getLogger", ("terrella",))?;
            logger.call_method1(name, ("%s", record.args().to_string()))?;
            Ok(())
        });
    }

    fn flush(&self) {}
}

/// Begins to give warnings to Python, if no other logger has this process.
pub fn begin() {
    if log::set_logger(&PythonLogger).is_ok() {
        log::set_max_level(LevelFilter::Warn);
    }
}
