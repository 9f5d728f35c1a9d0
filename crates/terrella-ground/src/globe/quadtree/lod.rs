//! Level of detail (LOD) of the quadtree: how finely a view needs a square of ground.

use super::page::SquareInfo;
use crate::elevation::HeightRange;
use crate::globe::culling::{BoundVisibility, CullingContext, GroundBound, NormalCone};
use crate::globe::surface::GroundView;
use terrella_frames::Ellipsoid;

/// Rule by which a leaf is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SplitRule {
    /// Where its error may exceed the pixels that the view allows: the paper's e_max·λ > d (its formula 1) with λ = 1 / (pixel_rad ·
    /// tolerance_px).
    #[default]
    Tolerance,
    /// The same with a fixed λ, whatever the view allows; the paper's table has λ = 300.
    Paper {
        /// λ: metres of distance per metre of error.
        lambda: f64,
    },
    /// The paper's full form (its formula 2), k·l·L·λ·e_max / (2 tan(α/2)·d·ε) > 1. It is interpreted so that all units cancel. L / (2
    /// tan(α/2)·d) is a pixel for each metre at d, so l·L / (2 tan(α/2)·d) is the side of the square in pixels. λ·e_max is its error in
    /// pixels, and ε the pixels that the view allows. Small squares may then have larger errors.
    Full {
        /// k, per pixel of the square's side.
        k: f64,
    },
}

/// Factor on the ratio of a leaf outside the image. Its error may be larger, but not without limit: the eye may turn to it.
const OUTSIDE: f64 = 0.1;
/// Smallest distance used, metres.
const MIN_DISTANCE_M: f64 = 1e-3;

/// A view and the detail that it needs.
pub struct LodView {
    culling: CullingContext,
    /// A ratio is error / distance times this; for the full form, times the side's pixels too.
    factor: f64,
    full: Option<f64>,
    /// Whether anything may be culled.
    is_culled: bool,
}

impl LodView {
    /// A view of ground whose terrain is drawn between the heights of `drawn`; `None` if the view is not finite.
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

    /// Distance from the eye to the terrain drawn for a square, metres; at least a millimetre.
    pub fn distance_m(&self, info: &SquareInfo) -> f64 {
        self.culling.distance_m(&info.bound()).max(MIN_DISTANCE_M)
    }

    /// Ratio of a leaf's error to the allowed one: a leaf above 1 should be divided. `side_m` is the side of its square.
    pub fn split_ratio(&self, info: &SquareInfo, side_m: f64, visibility: BoundVisibility) -> f64 {
        seen_ratio(
            self.full_ratio(info, self.distance_m(info), side_m),
            visibility,
        )
    }

    /// The same for a leaf at a distance that is fully visible: never less than [`Self::split_ratio`].
    pub fn full_ratio(&self, info: &SquareInfo, distance_m: f64, side_m: f64) -> f64 {
        let mut ratio = f64::from(info.error_m) / distance_m * self.factor;
        if let Some(k) = self.full {
            ratio *= k * side_m / distance_m;
        }
        ratio
    }

    /// Size of an error at a distance, pixels.
    pub fn error_px(&self, error_m: f64, distance_m: f64) -> f64 {
        error_m / (distance_m * self.culling.pixel_rad)
    }

    /// Visibility of a square.
    pub fn visibility(&self, info: &SquareInfo) -> BoundVisibility {
        match self.is_culled {
            true => self.culling.visibility(&info.bound()),
            false => BoundVisibility::Inside,
        }
    }

    /// Visibility of a square inside another with visibility `above`. It is not visible if the outer square is not.
    pub fn visibility_within(&self, above: BoundVisibility, info: &SquareInfo) -> BoundVisibility {
        match above {
            // A square fully inside the frustum has no part outside.
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

    /// Whether a patch is drawn: its ball may be visible, and one of its faces may face the eye.
    pub fn draws(&self, info: &SquareInfo, normals: &NormalCone) -> bool {
        let is_backfacing = self.is_culled && self.culling.is_backfacing(&info.bound(), normals);
        self.visibility(info).is_visible() && !is_backfacing
    }
}

/// The ratio of a leaf, reduced by its visibility.
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
            // The height was rounded to nearest.
            high_m: f64::from(self.high_m.next_up()),
        }
    }
}
