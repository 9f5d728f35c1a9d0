// An eye in the air: by the ray's direction, as far as the smooth ground. Ground with relief may be nearer, or stand where the
// smooth ground does not.

fn air_before(at: SurfacePoint, mu_s: f32) -> AirBefore {
    let to_ground = -at.to_eye * vec3f(1.0, 1.0, air.polar_stretch);
    let direction = normalize(to_ground);
    let uv = at.center_uv + at.uv;
    @if(!relief) let column = view_column(direction);
    // Of a mountain above the limb it is the air before the limb.
    @if(relief) let column = ground_view_column(max(tangent_below_limb(direction), 0.0));
    let air_ = AirBefore(through_seen(column), seen(column, direction, uv).rgb);
    @if(!relief) return air_;
    @if(relief) return thinned(air_, part_before(at, direction, length(to_ground)));
}
