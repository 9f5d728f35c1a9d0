// Clouds as a white layer on the ground.
import rust::CLOUDS;

const CLOUD_ALBEDO: f32 = 0.85;

fn under_clouds(ground: vec3f, at: SurfacePoint, light: Light, mu_s: f32) -> vec3f {
    let cover = sample_map(cloud_map, cloud_sampler, CLOUDS, at).r;
    let cloud = CLOUD_ALBEDO * (light.sun * max(mu_s, 0.0) + light.sky);
    return mix(ground, cloud, cover);
}
