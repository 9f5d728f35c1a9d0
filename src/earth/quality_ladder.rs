//! Quality ladders: the reductions in order, with their measured saving and error.

use super::quality::{Quality, QualityReduction};
use std::fmt::Write;
use terrella_files::excerpt;

/// The ladder of software adapters, written by `terrella report SCENE --quality`.
const SOFTWARE: &str = include_str!("quality_ladder/software.csv");

/// The columns of a ladder.
const COLUMNS: &str = "give_up,cost,error";
/// Most steps of a ladder.
const MAX_STEPS: usize = 64;

/// Reductions of quality in the order in which they are applied, with their measurements.
///
/// Its text form is a table of `give_up,cost,error`: names by [`QualityReduction::key`] joined by `+`, applied in addition to those of the steps
/// before; the frame time as a fraction of that at full quality; mean FLIP relative to full quality. Empty lines and lines that begin with `#` are
/// ignored. Costs decrease by at least [`Self::MIN_SAVING`] from step to step, and errors never decrease.
#[derive(Clone, Debug, PartialEq)]
pub struct QualityLadder {
    steps: Vec<QualityStep>,
}

/// A step of a [`QualityLadder`].
#[derive(Clone, Debug, PartialEq)]
pub struct QualityStep {
    /// Reductions in addition to those of the steps before.
    pub reductions: Vec<QualityReduction>,
    /// Frame time as a fraction of that at full quality, above 0 and below 1.
    pub cost: f64,
    /// Mean FLIP relative to full quality, 0…1.
    pub error: f64,
}

/// A quality level of an Earth, from [`QualityLadder::levels`].
#[derive(Clone, Debug, PartialEq)]
pub struct QualityLevel {
    /// Reductions in addition to the level above; none on the first.
    pub reductions: Vec<QualityReduction>,
    /// The resulting quality.
    pub quality: Quality,
    /// Frame time according to the ladder, as a fraction of that of the first level.
    pub cost: f64,
    /// Error according to the ladder, mean FLIP relative to the first level.
    pub error: f64,
}

/// An error in the text of a ladder.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}: {problem}")]
pub struct QualityLadderError {
    /// The line, from 1.
    pub line: usize,
    /// The problem and its remedy.
    pub problem: String,
}

impl QualityLadder {
    /// Least saving of each step, as a fraction of the cost of the step before.
    pub const MIN_SAVING: f64 = 0.03;

    /// Makes a ladder from any number of measured steps. Steps that save too little are merged into the next that saves enough, or dropped if there
    /// is none.
    pub fn of_steps(steps: impl IntoIterator<Item = QualityStep>) -> Self {
        let mut kept: Vec<QualityStep> = Vec::new();
        let mut pending = Vec::new();
        for mut step in steps {
            pending.append(&mut step.reductions);
            let (cost, error) = kept
                .last()
                .map_or((1.0, 0.0), |last| (last.cost, last.error));
            if step.cost <= (1.0 - Self::MIN_SAVING) * cost && kept.len() < MAX_STEPS {
                kept.push(QualityStep {
                    reductions: std::mem::take(&mut pending),
                    cost: step.cost,
                    // A step that costs less and has less error makes the step before it useless. Only rounding noise remains here.
                    error: step.error.max(error),
                });
            }
        }
        Self { steps: kept }
    }

    /// Reads the text of a ladder.
    ///
    /// # Errors
    /// The first line that violates the format of [`QualityLadder`].
    pub fn parse(text: &str) -> Result<Self, QualityLadderError> {
        let lines = text.lines().enumerate();
        let mut lines = lines
            .map(|(n, line)| (n + 1, line.trim()))
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let at = |line| move |problem: String| QualityLadderError { line, problem };
        let wrong = |line, problem: String| Err(at(line)(problem));
        match lines.next() {
            Some((_, COLUMNS)) => {}
            Some((line, _)) => return wrong(line, format!("the columns must be {COLUMNS}")),
            None => return wrong(1, format!("nothing here; the columns must be {COLUMNS}")),
        }
        let mut steps: Vec<QualityStep> = Vec::new();
        for (line, text) in lines {
            if steps.len() == MAX_STEPS {
                return wrong(line, format!("a ladder has at most {MAX_STEPS} steps"));
            }
            let step = QualityStep::parse(text).map_err(at(line))?;
            let given_up =
                |one: &QualityReduction| steps.iter().any(|before| before.reductions.contains(one));
            if let Some(twice) = step.reductions.iter().find(|one| given_up(one)) {
                return wrong(line, format!("{} is given up before already", twice.key()));
            }
            let (cost, error) = steps
                .last()
                .map_or((1.0, 0.0), |last| (last.cost, last.error));
            let most = (1.0 - Self::MIN_SAVING) * cost;
            if step.cost > most {
                let problem = format!(
                    "cost {} must be {most:.4} at most: each step saves {} % of the one before it",
                    step.cost,
                    100.0 * Self::MIN_SAVING
                );
                return wrong(line, problem);
            }
            if step.error < error {
                let problem = format!(
                    "error {} must be {error} at least, that of the step before it",
                    step.error
                );
                return wrong(line, problem);
            }
            steps.push(step);
        }
        Ok(Self { steps })
    }

    /// The ladder for an adapter class. Only software adapters have a recorded one; other classes use it too, although its savings are not known
    /// there.
    pub fn recorded() -> Self {
        // A test parses this text. Without steps nothing is reduced.
        Self::parse(SOFTWARE).unwrap_or(Self { steps: Vec::new() })
    }

    /// Its steps, in the order in which they are applied.
    pub fn steps(&self) -> &[QualityStep] {
        &self.steps
    }

    /// Writes the text that [`Self::parse`] reads, after comment lines with `remarks`.
    pub fn to_text(&self, remarks: &str) -> String {
        let mut text = String::new();
        for remark in remarks.lines() {
            let _ = writeln!(text, "# {remark}");
        }
        let _ = writeln!(text, "{COLUMNS}");
        for step in &self.steps {
            let keys: Vec<_> = step.reductions.iter().map(|one| one.key()).collect();
            let _ = writeln!(
                text,
                "{},{:.4},{:.5}",
                keys.join("+"),
                step.cost,
                step.error
            );
        }
        text
    }

    /// The levels of an Earth, starting with `full`. Steps without effect on it are left out, so that each level reduces something. Costs and
    /// errors are those of the ladder, relative to `full`.
    pub fn levels(&self, full: Quality, has_tiles: bool) -> Vec<QualityLevel> {
        let mut levels = vec![QualityLevel {
            reductions: Vec::new(),
            quality: full,
            cost: 1.0,
            error: 0.0,
        }];
        let (mut quality, mut cost, mut error) = (full, 1.0, 0.0);
        let (mut cost_before, mut error_before) = (1.0, 0.0);
        for step in &self.steps {
            let mut reductions = Vec::new();
            for reduction in &step.reductions {
                let less = reduction.apply(quality, has_tiles);
                if less != quality {
                    reductions.push(*reduction);
                    quality = less;
                }
            }
            if !reductions.is_empty() {
                cost *= step.cost / cost_before;
                error += step.error - error_before;
                levels.push(QualityLevel {
                    reductions,
                    quality,
                    cost,
                    error,
                });
            }
            (cost_before, error_before) = (step.cost, step.error);
        }
        levels
    }
}

impl QualityStep {
    fn parse(text: &str) -> Result<Self, String> {
        let fields: Vec<_> = text.split(',').map(str::trim).collect();
        let [give_up, cost, error] = fields[..] else {
            return Err(format!(
                "{} fields, not the three of {COLUMNS}",
                fields.len()
            ));
        };
        let mut reductions = Vec::new();
        for key in give_up.split('+') {
            let Some(one) = QualityReduction::of_key(key.trim()) else {
                let known: Vec<_> = QualityReduction::ALL.iter().map(|one| one.key()).collect();
                return Err(format!(
                    "{} cannot be given up; what can is {}",
                    excerpt(key),
                    known.join(", ")
                ));
            };
            if reductions.contains(&one) {
                return Err(format!("{key} is given up twice"));
            }
            reductions.push(one);
        }
        let number = |name: &str, text: &str| -> Result<f64, String> {
            let value = text.parse::<f64>().ok();
            let value = value.filter(|value| (0.0..=1.0).contains(value));
            value.ok_or_else(|| {
                let text = excerpt(text);
                format!("{name} is {text}; it must be a number from 0 to 1")
            })
        };
        let (cost, error) = (number("cost", cost)?, number("error", error)?);
        if cost == 0.0 {
            return Err("cost is 0; it must be above".into());
        }
        Ok(Self {
            reductions,
            cost,
            error,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::quality::TILED_SUBDIVISION;
    use super::*;
    use terrella_ground::air::Atmosphere;
    use terrella_ground::globe::Subdivision;
    use terrella_imagery::tile::MAP_LAYERS;

    fn full() -> Quality {
        Quality {
            subdivision: Subdivision::Auto,
            anisotropy: 8,
            samples: 4,
            texel_px: 1.0,
            maps: [true; MAP_LAYERS],
            atmosphere: Atmosphere::Billboard,
            scale: 1.0,
        }
    }

    #[test]
    fn each_recorded_step_saves_time_and_none_is_nearer_to_the_truth_than_the_one_before() {
        let ladder = QualityLadder::parse(SOFTWARE).expect("a good ladder");
        assert_eq!(ladder, QualityLadder::recorded());
        assert!(ladder.steps().len() >= 3, "{}", ladder.steps().len());
        let mut before = (1.0, 0.0);
        for step in ladder.steps() {
            let saved = 1.0 - step.cost / before.0;
            assert!(
                saved >= QualityLadder::MIN_SAVING - 1e-12,
                "{step:?}: {saved}"
            );
            assert!(step.error >= before.1, "{step:?}");
            before = (step.cost, step.error);
        }
        // The picture's scale is one of its means.
        let is_scale = |one: &QualityReduction| matches!(one, QualityReduction::Scale(_));
        let mut all = ladder.steps().iter().flat_map(|step| &step.reductions);
        assert!(all.any(is_scale));
        assert_eq!(
            QualityLadder::parse(&ladder.to_text("a remark\nin two lines")),
            Ok(ladder)
        );
    }

    #[test]
    fn levels_give_up_more_and_more_and_cost_less_and_less() {
        let levels = QualityLadder::recorded().levels(full(), false);
        assert_eq!((levels[0].quality, levels[0].reductions.len()), (full(), 0));
        for pair in levels.windows(2) {
            let left = pair[1].reductions.iter();
            let left = left.fold(pair[0].quality, |quality, one| one.apply(quality, false));
            assert_eq!(left, pair[1].quality);
            assert_ne!(left, pair[0].quality);
            assert!(pair[1].cost < pair[0].cost && pair[1].error >= pair[0].error);
        }
    }

    #[test]
    fn what_changes_nothing_is_no_level() {
        let ladder = "give_up,cost,error\nsamples,0.5,0\nroundness+lights,0.4,0.01\nair,0.2,0.03\n";
        let ladder = QualityLadder::parse(ladder).expect("a good ladder");
        let single = Quality {
            samples: 1,
            ..full()
        };
        let levels = ladder.levels(single, true);
        assert_eq!(levels.len(), 3);
        assert!((levels[1].cost - 0.8).abs() < 1e-12 && (levels[1].error - 0.01).abs() < 1e-12);
        assert!((levels[2].cost - 0.4).abs() < 1e-12);
        let cells = Subdivision::Cells(TILED_SUBDIVISION);
        assert_eq!(levels[1].quality.subdivision, cells);
        let bare = Quality {
            subdivision: Subdivision::Cells(6),
            maps: [true, false, false, false, false],
            atmosphere: Atmosphere::None,
            ..single
        };
        assert_eq!(ladder.levels(bare, false).len(), 1);
    }

    #[test]
    fn steps_that_save_too_little_are_joined_or_dropped() {
        let step = |key: &str, cost, error| QualityStep {
            reductions: vec![QualityReduction::of_key(key).expect("a word")],
            cost,
            error,
        };
        let ladder = QualityLadder::of_steps([
            step("samples", 0.5, 0.001),
            step("relief", 0.49, 0.002),
            step("lights", 0.45, 0.003),
            step("air", 0.44, 0.02),
        ]);
        assert_eq!(ladder.steps().len(), 2);
        assert_eq!(ladder.steps()[1].reductions.len(), 2);
        assert_eq!(QualityLadder::parse(&ladder.to_text("")), Ok(ladder));
    }

    #[test]
    fn bad_ladders_are_rejected_by_their_line() {
        for (text, line, word) in [
            ("", 1, "columns"),
            ("give_up,cost\n", 1, "columns"),
            ("# x\ngive_up,cost,error\nsamples,0.5\n", 3, "fields"),
            ("give_up,cost,error\nsmiles,0.5,0\n", 2, "samples"),
            ("give_up,cost,error\nair+air,0.5,0\n", 2, "twice"),
            ("give_up,cost,error\nair,0.5,0\nair,0.3,0\n", 3, "already"),
            ("give_up,cost,error\nair,nan,0\n", 2, "number"),
            ("give_up,cost,error\nair,0,0\n", 2, "above"),
            ("give_up,cost,error\nair,0.98,0\n", 2, "0.9700"),
            ("give_up,cost,error\nair,0.5,1.5\n", 2, "error is"),
            (
                "give_up,cost,error\nair,0.5,0.2\nlights,0.4,0.1\n",
                3,
                "at least",
            ),
        ] {
            let error = QualityLadder::parse(text).expect_err(text);
            assert_eq!(error.line, line, "{text}: {error}");
            assert!(error.to_string().contains(word), "{error}");
        }
        let many: String = (25..=99)
            .map(|n| format!("scale_{n},{},0\n", 0.9_f64.powi(n)))
            .collect();
        let error = QualityLadder::parse(&format!("give_up,cost,error\n{many}"));
        assert!(error.expect_err("too many").problem.contains("64"));
    }
}
