//! The files of `shaders/`, embedded.

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        /// Name below `shaders/` and text of each file that shaders are put together from.
        pub const FILES: &[(&str, &str)] = &[
            $(($name, include_str!(concat!("../../../shaders/", $name)))),*
        ];
    };
}

files![
    "air.wgsl",
    "air/depth.wgsl",
    "air/inside.wgsl",
    "air/outside.wgsl",
    "common/air_tables.wgsl",
    "common/color.wgsl",
    "common/frame.wgsl",
    "earth.wgsl",
    "earth/bindings.wgsl",
    "earth/fragment/color.wgsl",
    "earth/fragment/color_and_depth.wgsl",
    "earth/fragment/geolocation.wgsl",
    "earth/fragment/picture.wgsl",
    "earth/maps/per_block_tiles.wgsl",
    "earth/maps/tile_placements.wgsl",
    "earth/maps/tiles.wgsl",
    "earth/maps/whole_maps.wgsl",
    "earth/normal/ellipsoid.wgsl",
    "earth/normal/normal_map.wgsl",
    "earth/normal/normal_map_on_relief.wgsl",
    "earth/normal/relief.wgsl",
    "earth/shading/clouds.wgsl",
    "earth/shading/fresnel.wgsl",
    "earth/shading/light_through_air.wgsl",
    "earth/shading/light_without_air.wgsl",
    "earth/shading/night_lights.wgsl",
    "earth/shading/paper.wgsl",
    "earth/shading/sea_glint.wgsl",
    "earth/shading/sunlit.wgsl",
    "earth/surface_point.wgsl",
    "earth/surface_point/contour_tree.wgsl",
    "earth/surface_point/on_relief.wgsl",
    "earth/surface_point/ray_cast.wgsl",
    "earth/surface_point/ray_on_ellipsoid.wgsl",
    "earth/surface_point/ray_to_mesh.wgsl",
    "earth/varying.wgsl",
    "earth/vertex/block_instance.wgsl",
    "earth/vertex/block_lattice.wgsl",
    "earth/vertex/contour_prisms.wgsl",
    "earth/vertex/projected_grid.wgsl",
    "earth/vertex/projected_grid_point.wgsl",
    "earth/vertex/projected_grid_uniforms.wgsl",
    "earth/vertex/relief_patches.wgsl",
    "tracks.wgsl",
    "tracks/fills.wgsl",
    "tracks/lines.wgsl",
    "tracks/marks.wgsl",
];
