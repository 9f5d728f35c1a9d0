// The surface of the Earth: the files of a variant, stage by stage. `EarthVariant` in src/gpu/shader/earth.rs lists the legal combinations of
// conditions; src/gpu/shader/mod.rs explains `@if` and `import`.

import common/frame.wgsl;
import earth/bindings.wgsl;
@if(!points && !beside_ground) import earth/varying.wgsl;

// Vertex stage: form of the mesh.
@if(blocks) import earth/vertex/block_lattice.wgsl;
@if(patches) import earth/vertex/relief_patches.wgsl;
@if(grid) import earth/vertex/projected_grid.wgsl;
@if(cast) import earth/vertex/contour_prisms.wgsl;

// Surface point of a pixel: fn surface_point(in: Varying) -> SurfacePoint.
import earth/surface_point.wgsl;
@if(relief) import earth/surface_point/on_relief.wgsl;
@if(!relief && !points && !beside_ground) import earth/surface_point/ray_on_ellipsoid.wgsl;

// Sampling of maps at that point: fn sample_map(map, filtering, layer, at: SurfacePoint) -> vec4f.
@if(!geolocation) import earth/maps.wgsl;
@if(per_block_tiles) import earth/blocks.wgsl;

// Normal of the ground: fn surface_normal(at: SurfacePoint) -> vec3f.
@if(!geolocation && !points && !beside_ground) import earth/surface_normal.wgsl;

// Shading: fn shade(at: SurfacePoint) -> vec3f.
@if(paper) import earth/shading/paper.wgsl;
@if(sunlit && !points && !beside_ground) import earth/shading/sunlit.wgsl;

// Fragment stage: output.
@if(!points && !beside_ground) import earth/fragment.wgsl;

// Both stages of city lights drawn over it, and of clouds beside it: overhead for an eye below them, around an eye within them, and above the edge of
// the ground.
@if(points) import earth/city_lights.wgsl;
@if(overhead) import earth/clouds_overhead.wgsl;
@if(around) import earth/clouds_around.wgsl;
@if(limb) import earth/clouds_at_limb.wgsl;
