// Spacing of the sky view on either side of the limb: by the tangent x of half the angle from it, 0…1, as √(x(1 + k)/(x + k)), so that most samples
// are near the limb, even if all air is within 10° of it.
const VIEW_CROWDING: f32 = 0.25;

fn view_spacing(x: f32) -> f32 {
    return sqrt(x * (1.0 + VIEW_CROWDING) / (x + VIEW_CROWDING));
}

fn view_spacing_inverse(s: f32) -> f32 {
    return s * s * VIEW_CROWDING / (1.0 + VIEW_CROWDING - s * s);
}
