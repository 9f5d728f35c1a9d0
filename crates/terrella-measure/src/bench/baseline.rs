//! A run compared with an earlier one: the same scene, size and adapter, and only ratios.

use super::error::BenchError;
use super::interval::Interval;
use super::report::{BenchReport, BenchRow};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// An earlier report and where it came from.
#[derive(Clone, Debug)]
pub struct Baseline {
    path: PathBuf,
    report: BenchReport,
}

/// A row now and then.
#[derive(Clone, Debug, PartialEq)]
pub struct RowChange {
    /// Height and path.
    pub row: String,
    /// Frame over floor in the baseline.
    pub before: f64,
    /// Frame over floor in this run.
    pub now: f64,
    /// Now ÷ before, view by view.
    pub times: Interval,
}

/// All rows of two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// In the order of the rows.
    pub changes: Vec<RowChange>,
    /// Part by which a row must be slower to count.
    pub smallest_effect: f64,
}

/// Confidence, over all rows together, that no row is called slower because of noise alone.
const CONFIDENCE: f64 = 0.95;
/// Runs on a side from which their spread is reported.
const RUNS_TO_TELL: u32 = 3;

impl Baseline {
    /// Reads one.
    ///
    /// # Errors
    /// As [`BenchReport::load`].
    pub fn load(path: &Path) -> Result<Self, BenchError> {
        Ok(Self {
            path: path.into(),
            report: BenchReport::load(path)?,
        })
    }

    /// Rejects a baseline of another scene, size or number of frames. The adapter and the maps need not be known yet.
    ///
    /// # Errors
    /// The first difference.
    pub fn check_settings(&self, run: &BenchReport) -> Result<(), BenchError> {
        let there = &self.report;
        let size = |report: &BenchReport| format!("{} × {}", report.size[0], report.size[1]);
        self.same("size", size(there), size(run))?;
        self.same("frames", there.frames, run.frames)?;
        let value = |of: &BTreeMap<String, String>, key: &str| {
            of.get(key).map_or("not given".to_owned(), String::clone)
        };
        for key in run.scene.keys() {
            let name = format!("the scene's {key}");
            self.same(&name, value(&there.scene, key), value(&run.scene, key))?;
        }
        Ok(())
    }

    /// Rejects one of another adapter or of other maps too. Everything of `run` but its rows is known by now.
    ///
    /// # Errors
    /// The first difference.
    pub fn check_all(&self, run: &BenchReport) -> Result<(), BenchError> {
        let there = &self.report;
        self.same("adapter", &there.adapter, &run.adapter)?;
        self.same("backend", &there.backend, &run.backend)?;
        self.check_settings(run)?;
        self.same("the number of samples drawn", there.samples, run.samples)?;
        for key in there
            .scene
            .keys()
            .filter(|key| !run.scene.contains_key(*key))
        {
            self.same(
                &format!("the scene's {key}"),
                &there.scene[key],
                &"not given".to_owned(),
            )?;
        }
        Ok(())
    }

    fn same<T: PartialEq + std::fmt::Debug>(
        &self,
        what: &str,
        there: T,
        here: T,
    ) -> Result<(), BenchError> {
        if there == here {
            return Ok(());
        }
        Err(BenchError::OtherBaseline {
            path: self.path.clone(),
            what: what.to_owned(),
            // Quoted, so that nothing that a file holds reaches the terminal as it is.
            there: format!("{there:?}"),
            here: format!("{here:?}"),
        })
    }

    /// Other differences between the machines, and comparisons that the runs do not allow.
    pub fn notices(&self, run: &BenchReport) -> Vec<String> {
        let there = &self.report;
        let mut notices = Vec::new();
        for (what, there, here) in [
            ("driver", &there.driver, &run.driver),
            ("processor", &there.cpu, &run.cpu),
            ("operating system", &there.os, &run.os),
        ] {
            if there != here {
                notices.push(format!(
                    "the baseline's {what} is {there:?}, this run's {here:?}: what differs may be the machine"
                ));
            }
        }
        if there.repeats.min(run.repeats) < RUNS_TO_TELL {
            notices.push(format!(
                "intervals know how frames differ, and how runs do only with {RUNS_TO_TELL} runs and more on both sides; there are \
                 {} and {} (--repeats)",
                there.repeats, run.repeats
            ));
        }
        notices
    }

    /// Compares all rows of a complete run: a row is slower if its whole interval is.
    ///
    /// The interval of each row has a confidence of 1 − 0.05/rows. Over all rows together, noise then calls none slower with a probability of 95 %
    /// (Bonferroni).
    ///
    /// # Errors
    /// A row that only one of them has.
    pub fn compare(
        &self,
        run: &BenchReport,
        smallest_effect: f64,
    ) -> Result<Comparison, BenchError> {
        self.check_all(run)?;
        let names =
            |report: &BenchReport| report.rows.iter().map(BenchRow::name).collect::<Vec<_>>();
        self.same("the list of rows", names(&self.report), names(run))?;
        let confidence = 1.0 - (1.0 - CONFIDENCE) / run.rows.len().max(1) as f64;
        let pairs = self.report.rows.iter().zip(&run.rows);
        Ok(Comparison {
            changes: pairs
                .map(|(there, here)| RowChange {
                    row: here.name(),
                    before: there.floor_ratio,
                    now: here.floor_ratio,
                    times: Interval::of(&there.ratios(), &here.ratios(), confidence),
                })
                .collect(),
            smallest_effect,
        })
    }
}

impl Comparison {
    /// Rejects a run of which a row is slower.
    ///
    /// # Errors
    /// [`BenchError::Slower`].
    pub fn verdict(&self) -> Result<(), BenchError> {
        let effect = self.smallest_effect;
        let slower = self.changes.iter();
        let slower = slower.filter(|change| change.times.is_slower(effect));
        let worst = slower
            .clone()
            .max_by(|a, b| a.times.median.total_cmp(&b.times.median));
        match worst {
            None => Ok(()),
            Some(worst) => Err(BenchError::Slower {
                count: slower.count(),
                rows: self.changes.len(),
                effect_pct: 100.0 * effect,
                worst: format!(
                    "{} from {:.2} to {:.2} × the floor ({})",
                    worst.row, worst.before, worst.now, worst.times
                ),
            }),
        }
    }
}
