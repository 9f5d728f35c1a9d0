// Shadows of clouds: the cover where the ray to the Sun leaves their layer.

// A Sun lower than this casts shadows longer than clouds are far apart.
const LOWEST_SHADOW: f32 = 0.05;
// Their edges are soft: they need no detail as small as the clouds' own.
const SHADOW_PIXELS: f32 = 4.0;

fn below_clouds(at: SurfacePoint, light: Light, sun: vec3f, mu_s: f32) -> Light {
    let lift = lifted(at, sun, max(mu_s, LOWEST_SHADOW), surface_light.cloud_height);
    let albedo = CLOUD_ALBEDO * cover_at(at, lift, SHADOW_PIXELS);
    let left = 1.0 - sunlit_albedo(albedo, max(mu_s, LOWEST_SHADOW));
    // What falls through is spread over the sky: half of it comes from there.
    return Light(light.sun * left, light.sky * (1.0 - 0.5 * albedo));
}
