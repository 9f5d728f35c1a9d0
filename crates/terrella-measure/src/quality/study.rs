//! Results as tables and a chart.

use super::search::{Combination, ladder_of};
use crate::output::csv_text;
use crate::{Chart, Point, Series};
use std::fmt::Write;
use terrella::QualityLadder;

/// The columns of the table of all combinations.
const COLUMNS: [&str; 6] = ["give_up", "cost", "cost_q1", "cost_q3", "error", "taken"];

/// Every combination that was measured.
#[derive(Clone, Debug)]
pub struct QualityStudy {
    /// Name of the scene's file.
    pub scene: String,
    /// The adapter and its backend.
    pub adapter: String,
    /// Width and height of the pictures, pixels.
    pub size: (u32, u32),
    /// How often each was timed over all views.
    pub repeats: u32,
    pub views: usize,
    /// Measured combinations, in order.
    pub combinations: Vec<Combination>,
    /// Whether it was stopped early.
    pub is_stopped: bool,
}

impl QualityStudy {
    /// The ladder that follows.
    pub fn ladder(&self) -> QualityLadder {
        ladder_of(&self.combinations)
    }

    /// The ladder as a file for `[quality] ladder`.
    pub fn ladder_text(&self) -> String {
        let (width, height) = self.size;
        let remarks = format!(
            "Steps of quality, measured by `terrella report {} --quality`: {}, {width} x {height},\n\
             {} views, {} pairs of frames each; cost is the median of a frame's time (of the processor, on a software adapter) over that of full quality right before it,\n\
             weighed by views' times; error the mean of FLIP against the full quality.",
            self.scene, self.adapter, self.views, self.repeats
        );
        self.ladder().to_text(&remarks)
    }

    /// All combinations as a table.
    pub fn csv(&self) -> String {
        let head = std::iter::once(COLUMNS.map(String::from));
        csv_text(head.chain(self.combinations.iter().map(|one| {
            let [lower, median, upper] = one.cost;
            [
                keys(one),
                format!("{median:.4}"),
                format!("{lower:.4}"),
                format!("{upper:.4}"),
                format!("{:.5}", one.error),
                one.is_taken.to_string(),
            ]
        })))
    }

    /// The steps for a terminal: a line each.
    pub fn summary(&self) -> String {
        let mut text = format!(
            "{} combinations on {}\n{:>8} {:>9}  gives up\n",
            self.combinations.len(),
            self.adapter,
            "cost",
            "FLIP"
        );
        for step in self.ladder().steps() {
            let names: Vec<_> = step.reductions.iter().map(|one| one.to_string()).collect();
            // Writing to text cannot fail.
            let _ = writeln!(
                text,
                "{:>7.1}% {:>9.5}  {}",
                100.0 * step.cost,
                step.error,
                names.join(", ")
            );
        }
        text
    }

    /// Error against cost: all combinations, and the steps of the ladder.
    pub fn chart(&self) -> Chart {
        let all = self.combinations.iter();
        let ladder = self.ladder();
        let steps = ladder.steps().iter();
        Chart {
            title: "Reductions of quality".into(),
            x_name: "time of a frame, % of full quality".into(),
            y_name: "mean FLIP against full quality".into(),
            x_log: false,
            y_log: false,
            series: vec![
                Series {
                    name: "tried".into(),
                    points: all
                        .map(|one| Point::new(100.0 * one.cost(), one.error))
                        .collect(),
                    joined: false,
                },
                Series {
                    name: "ladder".into(),
                    points: steps
                        .map(|step| Point::new(100.0 * step.cost, step.error))
                        .collect(),
                    joined: true,
                },
            ],
        }
    }
}

fn keys(one: &Combination) -> String {
    let keys: Vec<_> = one.reductions.iter().map(|one| one.key()).collect();
    keys.join("+")
}
