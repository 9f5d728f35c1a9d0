// What detail that is made up does to what a map says.

struct Detail {
    // Of mean 0, and its variance, for pixels of one size.
    value: f32,
    variance: f32,
}

// A factor of mean 1 over the ground.
fn uneven_factor(contrast: f32, made: Detail) -> f32 {
    return exp(contrast * made.value - 0.5 * contrast * contrast * made.variance);
}

// A share of a pixel, 0…1, made uneven: none stays none and all stays all, and the mean over the ground stays about the same.
fn uneven_share(share: f32, contrast: f32, made: Detail) -> f32 {
    let odds = exp(contrast * made.value + (share - 0.5) * contrast * contrast * made.variance);
    return share * odds / (1.0 - share + share * odds);
}
