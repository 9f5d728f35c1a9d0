// Coordinates of the air's tables: the mapping of src/air/tables.rs, whose tables end on texel centres.
import rust::LOWEST_SUN;

fn table_coordinate(at: f32, texels: f32) -> f32 {
    return (clamp(at, 0.0, 1.0) * (texels - 1.0) + 0.5) / texels;
}

// 0…1 for a Sun cosine, quadratic about 0.
fn sun_coordinate(mu_s: f32) -> f32 {
    let low = -sqrt(-LOWEST_SUN);
    return (sign(mu_s) * sqrt(abs(mu_s)) - low) / (1.0 - low);
}
