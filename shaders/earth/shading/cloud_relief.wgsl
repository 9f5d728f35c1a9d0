// Rise of the clouds' tops to the east and to the north, thick clouds being higher than thin ones: from what the cover changes by
// to the next pixel right and down.
import rust::PI;

// Steepest that a cloud's top is drawn: a map's noise must not look like towers.
const STEEPEST: f32 = 0.7;

fn cloud_slope(at: SurfacePoint, cover: f32) -> vec2f {
    // Pixels as steps over the ground to the east and north, equatorial radii.
    let right = at.uv_dx * vec2f(2.0, -1.0) * PI;
    let down = at.uv_dy * vec2f(2.0, -1.0) * PI;
    let area = right.x * down.y - down.x * right.y;
    let dx = dpdx(cover);
    let dy = dpdy(cover);
    let gradient = vec2f(dx * down.y - dy * right.y, right.x * dy - down.x * dx) / select(area, 1.0, area == 0.0);
    let slope = surface_light.cloud_relief * gradient;
    return slope * min(STEEPEST * inverseSqrt(max(dot(slope, slope), 1e-12)), 1.0);
}
