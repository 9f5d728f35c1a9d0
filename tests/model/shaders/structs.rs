//! Structs that Rust writes and shaders read: offsets and sizes as naga lays them out.

use super::sampled_shaders;
use naga::TypeInner;
use std::mem::offset_of;
use terrella::internals::gpu::{CelestialUniforms, Disc, GradeUniforms, TrackUniforms};
use terrella::internals::plan::{
    AirUniforms, AuroraUniforms, FrameUniforms, GlowUniforms, MoonShadowUniforms,
    SurfaceLightUniforms,
};
use terrella_ground::globe::contours::ContourNode;
use terrella_ground::globe::projected_grid::{GridLevel, GridUniforms};

/// Member offsets and size of a struct, from a shader that has it.
fn reflected(name: &str) -> (Vec<(String, usize)>, usize) {
    for shader in sampled_shaders() {
        let mut types = shader.module.types.iter().map(|(_, ty)| ty);
        let ty = types.find(|ty| ty.name.as_deref() == Some(name));
        if let Some(TypeInner::Struct { members, span }) = ty.map(|ty| &ty.inner) {
            let offset = |member: &naga::StructMember| {
                let name = member.name.clone().unwrap_or_default();
                (name, member.offset as usize)
            };
            return (members.iter().map(offset).collect(), *span as usize);
        }
    }
    panic!("no shader has a struct {name}")
}

#[test]
fn structs_match_the_shaders() {
    macro_rules! check {
        ($name:literal, $ty:ident, [$($member:ident),* $(,)?]) => {{
            let (members, span) = reflected($name);
            let ours = vec![$((stringify!($member).to_owned(), offset_of!($ty, $member))),*];
            // Padding is only on the Rust side or on both; every named member must agree.
            let ours: Vec<_> = ours.into_iter().filter(|(name, _)| !name.starts_with("padding")).collect();
            let members: Vec<_> = members.into_iter().filter(|(name, _)| !name.starts_with("padding")).collect();
            assert_eq!(members, ours);
            assert_eq!(span, size_of::<$ty>(), "size of {}", $name);
        }};
    }
    check!(
        "MoonShadow",
        MoonShadowUniforms,
        [moon, radius, axis, spread]
    );
    check!(
        "FrameUniforms",
        FrameUniforms,
        [
            clip_from_eye,
            eye_scaled,
            above,
            sun_itrf,
            radius_m,
            corner_ray,
            polar_stretch,
            pixel_right,
            exposure,
            pixel_down,
            moon_light,
            moon_itrf,
            clouds_before,
            shadow,
            lamp_light,
            clouds_at_limb,
            clouds_reach,
            clouds_around
        ]
    );
    check!(
        "SurfaceLightUniforms",
        SurfaceLightUniforms,
        [
            wave_slope_squared,
            foam,
            mirror_power,
            mirror_scale,
            slope_gain,
            cloud_height,
            cloud_relief,
            cloud_dip
        ]
    );
    check!(
        "GradeUniforms",
        GradeUniforms,
        [
            balance_x,
            grain,
            balance_y,
            grain_size_px,
            balance_z,
            grain_seed
        ]
    );
    check!("TrackUniforms", TrackUniforms, [frame, size_px, air_top]);
    check!(
        "Disc",
        Disc,
        [pixel_x, distance, pixel_y, depth, pixel_z, covers, bounds]
    );
    check!(
        "CelestialUniforms",
        CelestialUniforms,
        [
            frame,
            size_px,
            origin_px,
            stars_x,
            star_gain,
            stars_y,
            milky_way_level,
            stars_z,
            sun_seen,
            sun,
            moon,
            moon_x,
            moon_level,
            moon_y,
            moon_albedo,
            moon_z,
            moon_lambert,
            moon_to_sun,
            earthshine,
            moon_to_earth,
            earth_radius,
            glare_bounds,
            near_depth,
            sun_kept,
            aperture
        ]
    );
    check!(
        "AirUniforms",
        AirUniforms,
        [
            across_x,
            eye_distance,
            across_y,
            eye_height,
            toward_center,
            exposure,
            sun,
            polar_stretch,
            sun_level,
            eye_sun,
            sky_albedo,
            limb_sin,
            molecules,
            limb_cos,
            ozone,
            aerosol_scattering,
            eye_moon,
            aerosol_extinction,
            moon_light,
            moon,
            moon_level,
            before_clouds,
            sky_albedo_of_clouds,
            shadow
        ]
    );
    check!(
        "GlowUniforms",
        GlowUniforms,
        [corner, depth, across, gain, down, above, beneath, bounds]
    );
    check!(
        "AuroraUniforms",
        AuroraUniforms,
        [
            pole, inner, noon, outer, green, center_sin, red, center_cos, folds, rays
        ]
    );
    check!(
        "GridLevel",
        GridLevel,
        [eye_cells, per_radian, period, size, padding]
    );
    check!(
        "GridUniforms",
        GridUniforms,
        [
            forward, corner, middle, corner_rad, right, cell_area, screen_up, longer, eye_up,
            limb_rad, eye_normal, sin_limb, to_base_m, cos_limb, radii_m, base_m, eye_lon, low,
            step, samples, near_rad, far_rad, spread_rad, eye_lat, center_lat, center_uv, levels,
            slots
        ]
    );
    check!(
        "ContourNode",
        ContourNode,
        [
            normal, ceiling, at, middle, walls, first, children, thickness, unused, slopes
        ]
    );
}
