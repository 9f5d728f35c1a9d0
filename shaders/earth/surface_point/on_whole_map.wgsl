// Coordinates on the whole Earth's maps for a point of which only the normal is known.
import rust::PI;

fn on_whole_map(point: SurfacePoint) -> SurfacePoint {
    var at = point;
    at.uv = vec2f(0.5 * atan2(at.up.y, at.up.x), -asin(clamp(at.up.z, -1.0, 1.0))) / PI;
    at.center_uv = vec2f(0.5);
    return at;
}
