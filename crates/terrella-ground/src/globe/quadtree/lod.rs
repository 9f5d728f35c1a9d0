//! Level of detail (LOD) of the quadtree: how finely a view asks for a square of ground to be drawn.

use super::page::SquareInfo;
use crate::elevation::HeightRange;
use crate::globe::culling::{BoundVisibility, CullingContext, GroundBound, NormalCone};
use crate::globe::surface::GroundView;
use terrella_frames::Ellipsoid;

/// When a leaf is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SplitRule {
    /// Where it may be off by more pixels than the view allows: the paper's e_max·λ > d (its formula 1) with
    /// λ = 1 / (pixel_rad · tolerance_px).
    #[default]
    Tolerance,
    /// The same with a λ of its own, whatever the view allows; the paper's table has λ = 300.
    Paper {
        /// λ: metres of distance for a metre of error.
        lambda: f64,
    },
    /// The paper's full form (its formula 2), k·l·L·λ·e_max / (2 tan(α/2)·d·ε) > 1. It is read so that all units cancel:
    /// L / (2 tan(α/2)·d) is a pixel for each metre at d, so l·L / (2 tan(α/2)·d) is the side of the square in pixels, λ·e_max
    /// its error in pixels, and ε the pixels that the view allows. Small squares may then be off by more.
    Full {
        /// k, of one pixel of the square's side.
        k: f64,
    },
}

/// A leaf outside the picture may be off by so much more: the eye may turn to it.
const OUTSIDE: f64 = 0.1;
/// No distance is taken for less, metres.
const MIN_DISTANCE_M: f64 = 1e-3;

/// A view and what it asks for.
pub struct LodView {
    culling: CullingContext,
    /// Ratio of the rule is error / distance times this; for the full form, times the side's pixels too.
    factor: f64,
    full: Option<f64>,
    /// Whether anything may be left out.
    is_culled: bool,
}

impl LodView {
    /// A view of ground of which nothing is drawn lower or higher than `drawn`; `None` where the view is not of numbers.
    pub fn new(
        view: &GroundView,
        rule: SplitRule,
        ellipsoid: &Ellipsoid,
        drawn: HeightRange,
        is_culled: bool,
    ) -> Option<Self> {
        let is_sound = view.eye_itrf_m.is_finite()
            && view.clip_from_eye.is_finite()
            && view.pixel_rad.is_finite()
            && view.pixel_rad > 0.0
            && !view.tolerance_px.is_nan();
        if !is_sound {
            return None;
        }
        let tolerance_px = view.tolerance_px.max(1e-3);
        let per_px = 1.0 / view.pixel_rad;
        let (factor, full) = match rule {
            SplitRule::Tolerance => (per_px / tolerance_px, None),
            SplitRule::Paper { lambda } => (lambda, None),
            SplitRule::Full { k } => (per_px / tolerance_px, Some(k * per_px)),
        };
        Some(Self {
            culling: CullingContext::new(view, ellipsoid, drawn),
            factor,
            full,
            is_culled,
        })
    }

    /// From the eye to what is drawn of a square, metres; at least a millimetre.
    pub fn distance_m(&self, info: &SquareInfo) -> f64 {
        self.culling.distance_m(&info.bound()).max(MIN_DISTANCE_M)
    }

    /// How far a leaf is from being fine enough: it is to be divided above 1. `side_m` is the side of its square.
    pub fn split_ratio(&self, info: &SquareInfo, side_m: f64, visibility: BoundVisibility) -> f64 {
        seen_ratio(
            self.full_ratio(info, self.distance_m(info), side_m),
            visibility,
        )
    }

    /// The same of a leaf at a distance that is seen as a whole: never less than [`Self::split_ratio`].
    pub fn full_ratio(&self, info: &SquareInfo, distance_m: f64, side_m: f64) -> f64 {
        let mut ratio = f64::from(info.error_m) / distance_m * self.factor;
        if let Some(k) = self.full {
            ratio *= k * side_m / distance_m;
        }
        ratio
    }

    /// How an error at a distance appears, pixels.
    pub fn error_px(&self, error_m: f64, distance_m: f64) -> f64 {
        error_m / (distance_m * self.culling.pixel_rad)
    }

    /// What is seen of a square.
    pub fn visibility(&self, info: &SquareInfo) -> BoundVisibility {
        match self.is_culled {
            true => self.culling.visibility(&info.bound()),
            false => BoundVisibility::Inside,
        }
    }

    /// What is seen of a square within another of which `above` is seen: nothing, where nothing is seen of that.
    pub fn visibility_within(&self, above: BoundVisibility, info: &SquareInfo) -> BoundVisibility {
        match above {
            // What lies in the frustum as a whole has no part outside.
            BoundVisibility::Inside if self.is_culled => {
                match self.culling.is_behind_horizon(&info.bound()) {
                    true => BoundVisibility::BehindHorizon,
                    false => BoundVisibility::Inside,
                }
            }
            BoundVisibility::Inside | BoundVisibility::Intersecting => self.visibility(info),
            hidden => hidden,
        }
    }

    /// Whether a patch is drawn: its ball may be seen, and one of its faces may face the eye.
    pub fn draws(&self, info: &SquareInfo, normals: &NormalCone) -> bool {
        let is_backfacing = self.is_culled && self.culling.is_backfacing(&info.bound(), normals);
        self.visibility(info).is_visible() && !is_backfacing
    }
}

/// The ratio of a leaf as far as it is seen.
pub fn seen_ratio(full_ratio: f64, visibility: BoundVisibility) -> f64 {
    match visibility {
        BoundVisibility::Inside | BoundVisibility::Intersecting => full_ratio,
        BoundVisibility::OutsideFrustum => full_ratio * OUTSIDE,
        BoundVisibility::BehindHorizon => 0.0,
    }
}

impl SquareInfo {
    fn bound(&self) -> GroundBound {
        GroundBound {
            center_itrf_m: self.center_itrf_m,
            radius_m: f64::from(self.radius_m),
            // It was rounded to the nearest.
            high_m: f64::from(self.high_m.next_up()),
        }
    }
}
