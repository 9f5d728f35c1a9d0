// Reflectance of water, n = 1.33, by Schlick 1994, for the cosine of the angle of incidence.
fn fresnel(cos_incidence: f32) -> f32 {
    return 0.02 + 0.98 * pow(1.0 - saturate(cos_incidence), 5.0);
}
