// A ray from outside the air: one look into the table of scattered light.

fn scattered(pass_: Pass) -> vec4f {
    if pass_.along <= 0.0 || pass_.q >= air.top {
        return vec4f(0.0);
    }
    let size = vec3f(textureDimensions(scattering_table));
    let half_ = 0.5 * size.x;
    let d = pass_.direction;
    var p: vec3f;
    var x: f32;
    var mu: f32;
    if pass_.q < 1.0 {
        mu = sqrt((1.0 - pass_.q) * (1.0 + pass_.q));
        p = pass_.nearest - d * mu;
        x = 0.5 * table_coordinate(sqrt(mu), half_);
    } else {
        mu = 0.0;
        p = pass_.nearest / pass_.q;
        x = 0.5 + 0.5 * table_coordinate(sqrt((pass_.q - 1.0) / (air.top - 1.0)), half_);
    }
    let mu_s = clamp(dot(p, air.sun), -1.0, 1.0);
    // Azimuth of the Sun about the reference point, from the ray's horizontal direction.
    let flat = sqrt(max((1.0 - mu * mu) * (1.0 - mu_s * mu_s), 1e-12));
    let cosine = clamp((dot(d, air.sun) + mu * mu_s) / flat, -1.0, 1.0);
    let at = vec3f(
        x,
        table_coordinate(sun_coordinate(mu_s), size.y),
        table_coordinate(acos(cosine) / PI, size.z),
    );
    return textureSampleLevel(scattering_table, table_sampler, at, 0.0);
}
