// The depth at which the air stands, where the ray enters it, moved before what the backend rounds to the same depth.

fn depth_of(pass_: Pass) -> f32 {
    let at = max(pass_.along - sqrt(max((air.top - pass_.q) * (air.top + pass_.q), 0.0)), 0.0);
    let clip = air.clip_from_billboard * vec4f(pass_.direction * at, 1.0);
    let depth = clip.z / max(clip.w, 1e-30);
    @if(standard_z) let before = select(depth - air.depth_rounding, 0.0, at == 0.0);
    @if(!standard_z) let before = select(depth + air.depth_rounding, 1.0, at == 0.0);
    return clamp(before, 0.0, 1.0);
}
