//! Nodes of a model that turn: where each is at an instant.

use crate::scene::{Articulation, ArticulationTarget, ArticulationTurn};
use glam::{DAffine3, DMat3, DVec3};
use terrella_model::Joint;

/// A joint of a model with what turns it, in the axes of the model as its file places it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnedJoint {
    /// The parent joint, as an index into the joints of the model.
    parent: Option<usize>,
    /// Where the axis goes through, metres.
    pivot_m: DVec3,
    /// Unit.
    axis: DVec3,
    turn: JointTurn,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum JointTurn {
    Even {
        angle_rad: f64,
        rate_rad_s: f64,
    },
    /// A unit direction is brought as near to this as it can be.
    Track {
        target: ArticulationTarget,
        normal: DVec3,
    },
}

/// What joints depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMoment {
    /// Since the scene's start, seconds.
    pub elapsed_s: f64,
    /// Unit vectors to the Sun and to the Earth's centre, in the axes of the model.
    pub sun: DVec3,
    pub earth: DVec3,
}

impl TurnedJoint {
    /// A joint turned as the scene says.
    pub fn new(joint: &Joint, turned: &Articulation) -> Self {
        let placed = |direction: DVec3| {
            let direction = joint.model_from_node.transform_vector3(direction);
            direction.normalize_or(DVec3::Z)
        };
        Self {
            parent: joint.parent,
            pivot_m: joint.model_from_node.transform_point3(DVec3::ZERO),
            axis: placed(turned.axis),
            turn: match turned.turn {
                ArticulationTurn::Even {
                    angle_deg,
                    rate_deg_s,
                } => JointTurn::Even {
                    angle_rad: angle_deg.to_radians(),
                    rate_rad_s: rate_deg_s.to_radians(),
                },
                ArticulationTurn::Track { target, normal } => JointTurn::Track {
                    target,
                    normal: placed(normal),
                },
            },
        }
    }

    /// By how much it is turned where its parent is turned so, radians.
    fn angle_rad(&self, parent: &DAffine3, moment: &JointMoment) -> f64 {
        match self.turn {
            JointTurn::Even {
                angle_rad,
                rate_rad_s,
            } => angle_rad + rate_rad_s * moment.elapsed_s,
            JointTurn::Track { target, normal } => {
                let toward = match target {
                    ArticulationTarget::Sun => moment.sun,
                    ArticulationTarget::Earth => moment.earth,
                };
                // As the joint sees it before it turns. Parents are rotations.
                let toward = parent.matrix3.transpose() * toward;
                // n·R(θ)ᵀs is greatest at θ = atan2(a·(n × s), (n × a)·(s × a)): the angle between the parts across the axis. Along the axis all
                // are alike.
                let sin = self.axis.dot(normal.cross(toward));
                let cos = normal.cross(self.axis).dot(toward.cross(self.axis));
                match sin.hypot(cos) > 1e-9 {
                    true => sin.atan2(cos),
                    false => 0.0,
                }
            }
        }
    }
}

/// The joints of a model, and where they are.
#[derive(Clone, Debug, Default)]
pub struct TurnedJoints {
    joints: Vec<TurnedJoint>,
    /// Their indices, parents first.
    order: Vec<usize>,
    moved: Vec<DAffine3>,
}

impl TurnedJoints {
    /// These, in the order of the model.
    pub fn new(joints: Vec<TurnedJoint>) -> Self {
        // Nodes form no cycle, and there are few joints.
        let depth = |index: usize| {
            let parent = |index: &usize| joints.get(*index)?.parent;
            let above = std::iter::successors(Some(index), parent);
            above.take(joints.len()).count()
        };
        let mut order: Vec<_> = (0..joints.len()).collect();
        order.sort_by_key(|index| depth(*index));
        Self {
            order,
            moved: vec![DAffine3::IDENTITY; joints.len()],
            joints,
        }
    }

    /// Where each joint has moved what the file has placed, in the axes of the model: a rotation and a shift.
    pub fn moved(&mut self, moment: &JointMoment) -> &[DAffine3] {
        for index in &self.order {
            let Some(joint) = self.joints.get(*index) else {
                continue;
            };
            let parent = joint.parent.and_then(|parent| self.moved.get(parent));
            let parent = parent.copied().unwrap_or(DAffine3::IDENTITY);
            let turn = DMat3::from_axis_angle(joint.axis, joint.angle_rad(&parent, moment));
            let shift_m = joint.pivot_m - turn * joint.pivot_m;
            if let Some(slot) = self.moved.get_mut(*index) {
                *slot = parent * DAffine3::from_mat3_translation(turn, shift_m);
            }
        }
        &self.moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;

    fn joint(parent: Option<usize>, model_from_node: DMat4) -> Joint {
        Joint {
            name: "Node".to_owned(),
            parent,
            model_from_node,
        }
    }

    fn turned(axis: DVec3, turn: ArticulationTurn) -> Articulation {
        Articulation {
            node: "Node".to_owned(),
            axis,
            turn,
        }
    }

    fn even(angle_deg: f64, rate_deg_s: f64) -> ArticulationTurn {
        ArticulationTurn::Even {
            angle_deg,
            rate_deg_s,
        }
    }

    fn moved(joints: &[TurnedJoint], moment: &JointMoment) -> Vec<DAffine3> {
        TurnedJoints::new(joints.to_vec()).moved(moment).to_vec()
    }

    const MOMENT: JointMoment = JointMoment {
        elapsed_s: 10.0,
        sun: DVec3::X,
        earth: DVec3::NEG_Z,
    };

    #[test]
    fn a_node_turns_about_its_own_origin_and_axis() {
        // Its z is the model's x; it stands at (0, 5, 0).
        let turn = DMat4::from_rotation_y(std::f64::consts::FRAC_PI_2);
        let placed = DMat4::from_translation(DVec3::Y * 5.0) * turn;
        let joint = TurnedJoint::new(&joint(None, placed), &turned(DVec3::Z, even(30.0, 6.0)));
        let [moved] = moved(&[joint], &MOMENT)[..] else {
            panic!("one joint");
        };
        // 30° + 10 s · 6°/s = 90° about x, counter-clockwise: y goes to z.
        let at = moved.transform_point3(DVec3::Y * 6.0);
        assert!(at.distance(DVec3::new(0.0, 5.0, 1.0)) < 1e-12, "{at}");
        let pivot = moved.transform_point3(DVec3::Y * 5.0);
        assert!(pivot.distance(DVec3::Y * 5.0) < 1e-12);
    }

    /// A child joint listed before its parent: first its own turn, then that of the parent.
    #[test]
    fn joints_move_with_their_parents() {
        let arm = joint(None, DMat4::IDENTITY);
        let hand = joint(Some(1), DMat4::from_translation(DVec3::X * 2.0));
        let about_z = |angle_deg| turned(DVec3::Z, even(angle_deg, 0.0));
        let joints = [
            TurnedJoint::new(&hand, &about_z(-90.0)),
            TurnedJoint::new(&arm, &about_z(90.0)),
        ];
        let moved = moved(&joints, &MOMENT);
        // The tip at x = 3: about the wrist at x = 2 to (2, −1), with the arm to (1, 2).
        let tip = moved[0].transform_point3(DVec3::X * 3.0);
        assert!(tip.distance(DVec3::new(1.0, 2.0, 0.0)) < 1e-12, "{tip}");
        let elbow = moved[1].transform_point3(DVec3::X * 2.0);
        assert!(elbow.distance(DVec3::Y * 2.0) < 1e-12);
    }

    /// Of all angles the one that is found brings the direction nearest to the Sun: looked for in steps.
    #[test]
    fn a_node_tracks_as_well_as_its_axis_lets_it() {
        let track = |normal| ArticulationTurn::Track {
            target: ArticulationTarget::Sun,
            normal,
        };
        let arm = joint(None, DMat4::from_rotation_x(0.4));
        let wing = joint(
            Some(0),
            DMat4::from_translation(DVec3::Y * 2.0) * DMat4::from_rotation_z(0.7),
        );
        let normal = DVec3::new(0.2, -0.3, 1.0);
        let joints = [
            TurnedJoint::new(&arm, &turned(DVec3::X, even(50.0, 0.0))),
            TurnedJoint::new(&wing, &turned(DVec3::new(0.0, 3.0, 1.0), track(normal))),
        ];
        for sun in [DVec3::X, DVec3::NEG_Z, DVec3::new(0.6, -0.64, 0.48)] {
            let moment = JointMoment { sun, ..MOMENT };
            let all = moved(&joints, &moment);
            let placed = wing.model_from_node.transform_vector3(normal).normalize();
            let got = all[1].transform_vector3(placed).dot(sun);
            let axis = wing
                .model_from_node
                .transform_vector3(DVec3::new(0.0, 3.0, 1.0));
            let best = (0..3600)
                .map(|step| {
                    let angle = f64::from(step).to_radians() / 10.0;
                    let turn = DMat3::from_axis_angle(axis.normalize(), angle);
                    all[0].transform_vector3(turn * placed).dot(sun)
                })
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(
                got >= best - 1e-12 && got < best + 1e-5,
                "{sun}: {got} {best}"
            );
        }
        // A Sun along the axis leaves the node as it is.
        let wing = joint(None, DMat4::IDENTITY);
        let joints = [TurnedJoint::new(&wing, &turned(DVec3::X, track(DVec3::Z)))];
        assert_eq!(moved(&joints, &MOMENT), [DAffine3::IDENTITY]);
    }

    #[test]
    fn a_node_can_face_the_earth() {
        let track = ArticulationTurn::Track {
            target: ArticulationTarget::Earth,
            normal: DVec3::Y,
        };
        let dish = joint(None, DMat4::IDENTITY);
        let joints = [TurnedJoint::new(&dish, &turned(DVec3::X, track))];
        let moved = moved(&joints, &MOMENT);
        assert!(moved[0].transform_vector3(DVec3::Y).distance(MOMENT.earth) < 1e-12);
    }
}
