// One frame's values, shared by all drawables. Mirrored by `Frame` in src/gpu/uniforms.rs; a test compares the offsets.
struct Frame {
    // Takes eye-relative ITRF metres to clip space.
    clip_from_eye: mat4x4f,
    // The eye, ITRF metres.
    eye_itrf_m: vec3f,
    // Sharpness of the polar axis: a²/b².
    normal_stretch: f32,
    // Unit vector to the Sun, ITRF axes.
    sun_itrf: vec3f,
    // Equatorial radius, metres.
    radius_m: f32,
    // What a white sheet that faces the Sun in space is drawn with.
    exposure: f32,
}
