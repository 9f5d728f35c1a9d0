//! Warnings of the library as records of Python's `logging`, under the logger `terrella`.

use log::{Level, LevelFilter, Log, Metadata, Record};
use pyo3::prelude::*;

/// The process's logger: forwards warnings and errors of Terrella's crates to Python.
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
        // At the interpreter's exit no logger is left.
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

/// Starts to forward warnings to Python, unless the process has another logger.
pub fn begin() {
    if log::set_logger(&PythonLogger).is_ok() {
        log::set_max_level(LevelFilter::Warn);
    }
}
