// The surface point of a pixel.
//
// The mesh only determines which pixels show ground; the place that they show follows from the pixel's own ray. So nothing is interpolated: facets
// seen edge-on, where interpolation is ill-conditioned, do not jitter, and a coarse mesh shifts nothing. Each
// method is a file of surface_point/ with
//   fn surface_point(in: Varying) -> SurfacePoint
import rust::PI;

// Effect of the air at a point, interpolated between vertices.
@if(interpolated)
struct AirAtPoint {
    // Transmittance for the ground's light, and the light added over black ground and per unit of light from the surrounding ground.
    through: vec3f,
    black: vec3f,
    bounce: vec3f,
    // Direct sunlight on horizontal ground, and skylight over black ground.
    sun: vec3f,
    sky: vec3f,
    @if(clouds) of_clouds: AirOfClouds,
}

// Effect of the air at the clouds in front of a point, as if their layer were the ground.
@if(clouds && air)
struct AirOfClouds {
    sun: vec3f,
    sky: vec3f,
    through: vec3f,
    black: vec3f,
    bounce: vec3f,
}

struct SurfacePoint {
    // Towards the eye, of any length.
    to_eye: vec3f,
    // Outward normal of the ellipsoid, unit vectors east and north.
    up: vec3f,
    east: vec3f,
    north: vec3f,
    // Texture coordinates on the whole map, relative to the block's centre.
    uv: vec2f,
    // Change of uv to the next pixel right and down, with u in ground distance like v (× cos latitude), so that the mip level follows the pixel's
    // footprint at the poles and has no seam at ±180°.
    uv_dx: vec2f,
    uv_dy: vec2f,
    center_uv: vec2f,
    @if(tiles) block: u32,
    // Slope of the ground to the east and to the north.
    @if(relief) slope: vec2f,
    // Distance of the ground in lengths of the pixel's ray, and its elevation above the ellipsoid.
    @if(relief) along: f32,
    @if(relief) height_m: f32,
    @if(truth) range_m: f32,
    @if(interpolated) air: AirAtPoint,
}

// From the eye through a pixel, ITRF axes, to the plane one metre in front of the eye.
fn pixel_ray(pixel: vec2f) -> vec3f {
    return frame.corner_ray + pixel.x * frame.pixel_right + pixel.y * frame.pixel_down;
}

// The surface point from its normal `up` and its distance, `radii` equatorial radii times the ray's length.
@if(!points && !beside_ground)
fn point_on_ray(in: Varying, ray: vec3f, radii: f32, up: vec3f) -> SurfacePoint {
    var out = seen_along(ray, radii, up);
    let angles = longitude_latitude(in, up, max(length(up.xy), 1e-7));
    out.uv = vec2f(angles.x / (2.0 * PI), -angles.y / PI);
    out.center_uv = in.center_uv;
    @if(truth) out.range_m = frame.radius_m * radii * length(ray);
    @if(tiles) out.block = in.block;
    return out;
}

// As `point_on_ray`, without the coordinates for maps.
fn seen_along(ray: vec3f, radii: f32, up: vec3f) -> SurfacePoint {
    var out: SurfacePoint;
    out.to_eye = -ray;
    out.up = up;
    let across = max(length(up.xy), 1e-7);
    out.east = vec3f(-up.y, up.x, 0.0) / across;
    out.north = cross(up, out.east);

    // The adjacent pixel's ray on the tangent plane: r − ray·(up·r)/(up·ray), times the distance in radii. Within the clouds there is no such plane.
    @if(overhead) let facing = max(dot(up, ray), 0.02 * length(ray));
    @if(!overhead && !around) let facing = min(dot(up, ray), -0.02 * length(ray));
    @if(!around) let dx = radii * (frame.pixel_right - ray * (dot(up, frame.pixel_right) / facing));
    @if(!around) let dy = radii * (frame.pixel_down - ray * (dot(up, frame.pixel_down) / facing));
    @if(around) let dx = radii * frame.pixel_right;
    @if(around) let dy = radii * frame.pixel_down;
    let to_uv = vec2f(0.5, -1.0) / PI;
    out.uv_dx = vec2f(dot(out.east, dx), dot(out.north, dx)) * to_uv;
    out.uv_dy = vec2f(dot(out.east, dy), dot(out.north, dy)) * to_uv;
    return out;
}

// Size of a pixel on the ground, equatorial radii: the geometric mean of its extents. Detail chosen by the larger one is blurred towards the horizon:
// compared with images of 16 samples, errors were 10 to 50 % larger.
fn pixel_radii(at: SurfacePoint) -> f32 {
    let to_radii = vec2f(2.0, 1.0) * PI;
    let x = at.uv_dx * to_radii;
    let y = at.uv_dy * to_radii;
    return sqrt(sqrt(dot(x, x) * dot(y, y)));
}
