// Effect of synthetic detail on a map's value.

struct Detail {
    // With mean 0, and its variance, for pixels of one size.
    value: f32,
    variance: f32,
}

// Structures of another strength.
fn scaled(strength: f32, made: Detail) -> Detail {
    return Detail(strength * made.value, strength * strength * made.variance);
}

// The sum of independent structures, the second ones of this strength.
fn plus(first: Detail, strength: f32, second: Detail) -> Detail {
    let added = scaled(strength, second);
    return Detail(first.value + added.value, first.variance + added.variance);
}

// A factor of mean 1 over the ground.
fn uneven_factor(contrast: f32, made: Detail) -> f32 {
    return exp(contrast * made.value - 0.5 * contrast * contrast * made.variance);
}

// For uneven shares of strong contrast, fitted to the tiles.
const MEAN_KEPT: f32 = 0.05;

// Makes a fraction of a pixel, 0…1, uneven: 0 and 1 are kept, and the mean over the ground within 7 % for clouds.
fn uneven_share(share: f32, contrast: f32, made: Detail) -> f32 {
    let spread = contrast * contrast * made.variance;
    let odds = exp(contrast * made.value + (share - 0.5) * spread * (1.0 - MEAN_KEPT * spread));
    return share * odds / (1.0 - share + share * odds);
}
