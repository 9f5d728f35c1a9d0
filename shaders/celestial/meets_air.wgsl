import rust::AIR_TOP;

// Of an eye outside of it.
fn meets_air(ray: Ray) -> bool {
    return ray.along > 0.0 && ray.q < AIR_TOP;
}
