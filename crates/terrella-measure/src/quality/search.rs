//! Which reduction is taken next, and the ladder of those that were.

use terrella::{QualityLadder, QualityReduction, QualityStep};

/// Error that no eye sees, mean FLIP: what adds less counts as adding this much, so that a free saving is not endlessly better.
const UNSEEN: f64 = 2e-4;

/// A combination of reductions, and its measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Combination {
    /// Its reductions, in the order of application.
    pub reductions: Vec<QualityReduction>,
    /// Time of the frames as part of those in full quality: median and quartiles of the repeats.
    pub cost: [f64; 3],
    /// Mean FLIP against the full quality.
    pub error: f64,
    /// Whether it was taken, and further reductions were tried on top of it.
    pub is_taken: bool,
}

impl Combination {
    /// The median of the cost.
    pub fn cost(&self) -> f64 {
        self.cost[1]
    }

    /// The resolution that it is given last, percent.
    fn added_scale(&self) -> Option<u8> {
        match self.reductions.last() {
            Some(QualityReduction::Scale(percent)) => Some(*percent),
            _ => None,
        }
    }

    fn step(&self, before: usize) -> QualityStep {
        QualityStep {
            reductions: self.reductions[before..].to_vec(),
            cost: self.cost(),
            error: self.error,
        }
    }
}

/// Of combinations that each add a reduction to one of this cost and error, the one with the largest saving per added error; `None` if none saves
/// as much as a step must.
///
/// Lower resolutions are one choice together, as good as the best of them. Of those that save enough the highest is taken, so that a ladder passes
/// through all that are worth a step.
pub fn best(cost: f64, error: f64, tried: &[Combination]) -> Option<usize> {
    let worth = |one: &Combination| (cost / one.cost()).ln() / (one.error - error).max(UNSEEN);
    let enough = (1.0 - QualityLadder::MIN_SAVING) * cost;
    let saving = tried.iter().enumerate();
    let saving: Vec<_> = saving.filter(|(_, one)| one.cost() <= enough).collect();
    let best = saving
        .iter()
        .max_by(|(_, a), (_, b)| worth(a).total_cmp(&worth(b)))?;
    let taken = match best.1.added_scale() {
        Some(_) => saving.iter().max_by_key(|(_, one)| one.added_scale())?,
        None => best,
    };
    Some(taken.0)
}

/// Whether another combination costs less, by at least the saving of a step, with no more error: smaller differences may be noise.
fn is_beaten(one: &Combination, all: &[Combination]) -> bool {
    let enough = (1.0 - QualityLadder::MIN_SAVING) * one.cost();
    all.iter()
        .any(|other| other.cost() <= enough && other.error <= one.error)
}

/// The ladder of those that were taken, without those that something else that was tried beats: the Pareto front of error and cost, as
/// far as one step comes to the one before.
pub fn ladder_of(combinations: &[Combination]) -> QualityLadder {
    let taken = combinations.iter();
    let taken = taken.filter(|one| one.is_taken && !is_beaten(one, combinations));
    let mut before = 0;
    QualityLadder::of_steps(taken.map(|one| {
        let step = one.step(before);
        before = one.reductions.len();
        step
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn combination(keys: &str, cost: f64, error: f64, is_taken: bool) -> Combination {
        let reductions = keys.split('+');
        Combination {
            reductions: reductions
                .map(|key| QualityReduction::of_key(key).expect("a word"))
                .collect(),
            cost: [cost; 3],
            error,
            is_taken,
        }
    }

    #[test]
    fn what_saves_most_for_its_error_is_taken() {
        let tried = [
            combination("samples", 0.6, 0.0001, false),
            combination("air", 0.3, 0.05, false),
            combination("lights", 0.98, 0.0, false),
        ];
        assert_eq!(best(1.0, 0.0, &tried), Some(0));
        assert_eq!(best(1.0, 0.0, &tried[1..]), Some(0));
        assert_eq!(best(1.0, 0.0, &tried[2..]), None);
        let scales = [
            combination("scale_85", 0.99, 0.005, false),
            combination("scale_70", 0.8, 0.006, false),
            combination("scale_35", 0.3, 0.007, false),
        ];
        assert_eq!(best(1.0, 0.0, &scales), Some(1));
        // Lower resolutions are worth more than lights, if not the first of them.
        let lights = [&scales[..], &[combination("lights", 0.9, 0.003, false)]].concat();
        assert_eq!(best(1.0, 0.0, &lights), Some(1));
        let cheap = [&scales[..2], &[combination("lights", 0.9, 0.0003, false)]].concat();
        assert_eq!(best(1.0, 0.0, &cheap), Some(2));
    }

    #[test]
    fn a_ladder_has_what_nothing_beats() {
        let ladder = ladder_of(&[
            combination("samples", 0.6, 0.001, true),
            combination("air", 0.7, 0.05, false),
            combination("samples+air", 0.5, 0.05, true),
            combination("samples+scale_50", 0.3, 0.02, false),
            combination("samples+air+scale_50", 0.2, 0.06, true),
        ]);
        let keys: Vec<Vec<String>> = ladder
            .steps()
            .iter()
            .map(|step| step.reductions.iter().map(|one| one.key()).collect())
            .collect();
        // The air alone is beaten by the scale alone, and so goes together with it.
        assert_eq!(keys, [vec!["samples"], vec!["air", "scale_50"]]);
        assert_eq!(ladder.steps()[1].cost, 0.2);
    }

    /// The table that the recorded ladder was chosen from.
    const RECORDED: &str = include_str!("../../../../src/earth/quality_ladder/software_tried.csv");

    #[test]
    fn the_recorded_ladder_is_what_was_measured_and_nothing_that_was_tried_beats_it() {
        let tried: Vec<_> = RECORDED
            .lines()
            .skip(1)
            .map(|line| {
                let fields: Vec<_> = line.split(',').collect();
                let number = |n: usize| fields[n].parse::<f64>().expect("a number");
                combination(fields[0], number(1), number(4), false)
            })
            .collect();
        assert!(tried.len() > 50);
        let ladder = QualityLadder::recorded();
        assert!(!ladder.steps().is_empty(), "a ladder that is read");
        for step in ladder.steps() {
            let same = |one: &&Combination| {
                (one.cost() - step.cost).abs() < 1e-9 && (one.error - step.error).abs() < 1e-9
            };
            let measured = tried.iter().find(same).expect("a row of the table");
            let added = |one: &QualityReduction| measured.reductions.contains(one);
            assert!(step.reductions.iter().all(added), "{step:?}");
            assert!(!is_beaten(measured, &tried), "{step:?}");
        }
    }
}
