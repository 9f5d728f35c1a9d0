// Land between the day map's texels.
import rust::DAY;
import earth/shading/detail.wgsl;

const LAND_CONTRAST: f32 = 0.35;
const LAND_ROUGHNESS: f32 = 0.6;

struct LandDetail {
    // A factor to the map's colour.
    brightness: f32,
    // How far the normal is tilted, times how steep the map's is: steep land is rough.
    tilt: vec3f,
}

fn land_detail(at: SurfacePoint) -> LandDetail {
    let made = detail(at.up, texel_radii(DAY, at, day_map), pixel_radii(at), 0.8);
    let level = made.slope - dot(made.slope, at.up) * at.up;
    return LandDetail(uneven_factor(LAND_CONTRAST, made), LAND_ROUGHNESS * level);
}
