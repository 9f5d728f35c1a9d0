//! One integration from a state to both ends of its span.

use super::event::EventDetector;
use super::force::EquationsOfMotion;
use super::integrate::{Dense, Driver, IntegrationFault};
use super::trajectory::Trajectory;
use super::{Event, EventKind, ForceModel, NumericalError, NumericalOptions, Spacecraft};
use crate::numerical::Counts;
use crate::{OrbitState, StartError};
use glam::DVec3;
use terrella_frames::{Duration, Epoch, rfc3339};

/// How a stretch ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum StopReason {
    /// At the end of the span.
    Limit,
    /// At the ground, seconds from the epoch.
    Impact(f64),
}

/// State of an integration.
pub(super) struct Integration<'a> {
    name: &'a str,
    epoch: Epoch,
    start: [f64; 6],
    model: &'a ForceModel,
    options: &'a NumericalOptions,
    motion: EquationsOfMotion,
    detector: EventDetector,
    pub trajectory: Trajectory,
    pub events: Vec<Event>,
    pub counts: Counts,
    /// Stretches that the implicit method flew, seconds from the epoch, the earlier end first.
    pub stiff: Vec<(f64, f64)>,
}

/// Longest span, days: 300 years.
const MAX_SPAN_DAYS: f64 = 110_000.0;

impl<'a> Integration<'a> {
    /// `start` is in GCRF.
    pub fn new(
        name: &'a str,
        start: &OrbitState,
        model: &'a ForceModel,
        craft: &Spacecraft,
        options: &'a NumericalOptions,
    ) -> Result<Self, NumericalError> {
        let range = |field, value, expected| {
            Err(NumericalError::from(StartError::Range {
                field,
                value,
                expected,
            }))
        };
        for (field, vector) in [
            ("position", start.position_m),
            ("velocity", start.velocity_m_s),
        ] {
            if !vector.is_finite() {
                return Err(StartError::NotFinite { field }.into());
            }
        }
        if !(1.0..1e12).contains(&start.position_m.length()) {
            return range(
                "distance from the Earth's centre, m,",
                start.position_m.length(),
                "1…1e12",
            );
        }
        if start.velocity_m_s.length() > 1e7 {
            return range("speed, m/s,", start.velocity_m_s.length(), "at most 1e7");
        }
        if !(1e-14..=1e-3).contains(&options.relative_tolerance) {
            return range(
                "relative tolerance",
                options.relative_tolerance,
                "1e-14…1e-3",
            );
        }
        if !(-10e3..=1000e3).contains(&options.ground_height_m) {
            return range(
                "height of the ground, m,",
                options.ground_height_m,
                "-1e4…1e6",
            );
        }
        let days = (options.last - options.first).to_seconds() / 86_400.0;
        if days > MAX_SPAN_DAYS {
            return range("span, days,", days, "at most 110 000");
        }
        model.check(craft)?;
        if start.epoch < options.first || start.epoch > options.last {
            return Err(NumericalError::Span {
                first: rfc3339(options.first),
                last: rfc3339(options.last),
                epoch: rfc3339(start.epoch),
            });
        }
        let mut motion =
            EquationsOfMotion::new(model, craft, start.epoch, options.relative_tolerance);
        let height_m = motion.height_m(0.0, start.position_m) - options.ground_height_m;
        if height_m < 0.0 {
            return Err(NumericalError::Start(StartError::BelowGround {
                satellite: name.to_owned(),
                depth_m: -height_m,
                surface: "the ground",
            }));
        }
        let (r, v) = (start.position_m, start.velocity_m_s);
        Ok(Self {
            name,
            epoch: start.epoch,
            start: [r.x, r.y, r.z, v.x, v.y, v.z],
            model,
            options,
            motion,
            detector: EventDetector::new(options.watch, options.ground_height_m),
            trajectory: Trajectory::default(),
            events: Vec::new(),
            counts: Counts::default(),
            stiff: Vec::new(),
        })
    }

    /// Integrates from the epoch to `end`, seconds from it, or to the ground.
    pub fn propagate(&mut self, end: f64) -> Result<StopReason, NumericalError> {
        if end == 0.0 {
            return Ok(StopReason::Limit);
        }
        let borders = self.borders(end);
        self.set_thrusts(0.0, borders.first().copied().unwrap_or(end));
        let (solver, relative) = (self.options.solver, self.options.relative_tolerance);
        let mut driver = Driver::new(solver, relative, &mut self.motion, 0.0, self.start)
            .map_err(|fault| self.fault(fault, 0.0, &self.start))?;
        for (k, &border) in borders.iter().enumerate() {
            if k > 0 {
                // The force is discontinuous: the method's history is no longer valid.
                self.set_thrusts(driver.t(), border);
                let y = *driver.y();
                driver
                    .restart(&mut self.motion, y)
                    .map_err(|fault| self.fault(fault, driver.t(), &y))?;
            }
            let ending = self.stretch(&mut driver, border);
            if border == end || !matches!(ending, Ok(StopReason::Limit)) {
                self.add_counts(driver.counts());
                return ending;
            }
        }
        Ok(StopReason::Limit)
    }

    fn stretch(
        &mut self,
        driver: &mut Driver<6>,
        border: f64,
    ) -> Result<StopReason, NumericalError> {
        while driver.t() != border {
            if self.trajectory.len() >= self.options.step_limit {
                return Err(NumericalError::StepLimit {
                    satellite: self.name.to_owned(),
                    epoch: self.epoch_text(driver.t()),
                    limit: self.options.step_limit,
                });
            }
            let step = driver
                .step(&mut self.motion, border)
                .map_err(|fault| self.fault(fault, driver.t(), driver.y()))?;
            let found = self.detector.events(&mut self.motion, &step);
            if matches!(step.dense, Dense::Implicit(_)) {
                self.add_stiff(step.t0, step.t1());
            }
            self.trajectory.push(step);
            for (t, kind) in found {
                let epoch = self.epoch + Duration::from_seconds(t);
                self.events.push(Event { epoch, kind });
                if kind == EventKind::Impact {
                    return Ok(StopReason::Impact(t));
                }
            }
        }
        Ok(StopReason::Limit)
    }

    /// Where thrusts begin and end on the way to `end`, and `end` itself, in the order of flight.
    fn borders(&self, end: f64) -> Vec<f64> {
        let mut borders: Vec<f64> = self
            .model
            .thrusts
            .iter()
            .flat_map(|thrust| [thrust.first, thrust.last])
            .map(|epoch| (epoch - self.epoch).to_seconds())
            .filter(|t| t * end.signum() > 0.0 && t.abs() < end.abs())
            .collect();
        borders.push(end);
        borders.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        borders.dedup();
        borders
    }

    /// Those that act between two times.
    fn set_thrusts(&mut self, from: f64, to: f64) {
        let middle = 0.5 * (from + to);
        let seconds = |epoch: Epoch| (epoch - self.epoch).to_seconds();
        self.motion.acting = (0..self.model.thrusts.len())
            .filter(|&k| {
                self.model.thrusts.get(k).is_some_and(|thrust| {
                    seconds(thrust.first) <= middle && middle < seconds(thrust.last)
                })
            })
            .collect();
    }

    fn fault(&self, fault: IntegrationFault, t: f64, y: &[f64; 6]) -> NumericalError {
        let satellite = self.name.to_owned();
        let epoch = self.epoch_text(t);
        match fault {
            IntegrationFault::NotFinite => NumericalError::Force { satellite, epoch },
            IntegrationFault::Underflow => {
                let position = DVec3::new(y[0], y[1], y[2]);
                let height_m = self.motion.clone().height_m(t, position);
                NumericalError::Underflow {
                    satellite,
                    epoch,
                    height_km: height_m / 1e3,
                }
            }
        }
    }

    fn epoch_text(&self, t: f64) -> String {
        rfc3339(self.epoch + Duration::from_seconds(t))
    }

    fn add_stiff(&mut self, from: f64, to: f64) {
        match self.stiff.last_mut() {
            Some(last) if last.1 == from => last.1 = to,
            Some(last) if last.0 == from => last.0 = to,
            _ => self.stiff.push((from.min(to), from.max(to))),
        }
    }

    fn add_counts(&mut self, more: Counts) {
        let sum = &mut self.counts;
        sum.evaluations += more.evaluations;
        sum.accepted += more.accepted;
        sum.rejected += more.rejected;
        sum.implicit += more.implicit;
        sum.jacobians += more.jacobians;
        sum.decompositions += more.decompositions;
        sum.switches += more.switches;
    }
}
