// Land between the day map's texels.
import rust::DAY;
import earth/shading/detail.wgsl;

const LAND_CONTRAST: f32 = 0.4;
const LAND_ROUGHNESS: f32 = 0.7;

// The same surface with its land uneven: brighter and darker, and rougher where it is steep.
fn with_detail(at: SurfacePoint, surface: Surface) -> Surface {
    let made = detail(at.up, texel_radii(DAY, at, textureDimensions(day_map)), pixel_radii(at), 0.75);
    let level = made.slope - dot(made.slope, at.up) * at.up;
    let steepness = length(cross(surface.normal, at.up));
    var out = surface;
    out.day = vec4f(out.day.rgb * uneven_factor(LAND_CONTRAST, made), out.day.a);
    out.normal = normalize(out.normal - LAND_ROUGHNESS * steepness * level);
    return out;
}
