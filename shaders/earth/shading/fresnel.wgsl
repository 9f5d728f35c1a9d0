// Reflectance of a smooth water surface for unpolarised light and the cosine of the angle of incidence, by Fresnel's equations
// in the form of Cook and Torrance 1982, with c = cos ω and g² = n² − 1 + c²:
//   ρ = ½ ((g − c)/(g + c))² (1 + ((c(g + c) − 1)/(c(g − c) + 1))²)
const SEA_WATER_INDEX: f32 = 1.34;

fn fresnel(cos_incidence: f32) -> f32 {
    let c = saturate(cos_incidence);
    let g = sqrt(SEA_WATER_INDEX * SEA_WATER_INDEX - 1.0 + c * c);
    let apart = (g - c) / (g + c);
    let ratio = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * apart * apart * (1.0 + ratio * ratio);
}
