// An eye outside the air: by the ray's zenith angle at the point.

fn air_before(at: SurfacePoint, mu_s: f32) -> AirBefore {
    let ray = -normalize(at.to_eye);
    let mu = clamp(-dot(ray, at.up), 0.0, 1.0);
    let x = ground_coordinate(mu);
    let uv = at.center_uv + at.uv;
    let sunlit = scattered(x, mu, ray, air.sun, mu_s, uv).rgb;
    @if(!moonlight) let light = sunlit;
    @if(moonlight) let light = sunlit + air.moon_light * scattered(x, mu, ray, air.moon, dot(at.up, air.moon), uv).rgb;
    @if(!relief) return AirBefore(through_at(x), light);
    // On a height there is less air, of the same shape.
    @if(relief) return thinned(AirBefore(through_at(x), light), exp(-at.height_m / AIR_SCALE_HEIGHT_M));
}
