// What the Moon leaves of the sunlight that the air before a point of the ground scatters.
import common/air/eclipsed.wgsl;

fn sun_on_air_before(at: SurfacePoint) -> vec3f {
    let stretch = vec3f(1.0, 1.0, air.polar_stretch);
    let ground = place_over(at.up, 0.0, air.polar_stretch) * stretch;
    let to_eye = normalize(at.to_eye);
    let reach = length(ground + air.eye_distance * air.toward_center);
    return sun_on_rising_air(ground, normalize(to_eye * stretch), max(dot(to_eye, at.up), 0.0), reach);
}
