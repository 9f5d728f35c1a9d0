// The surface of the Earth: the files that a variant is made of, stage by stage. `EarthVariant` in src/gpu/shader/earth.rs says
// which conditions hold together; src/gpu/shader/mod.rs explains `@if` and `import`.

import common/frame.wgsl;
import earth/bindings.wgsl;
@if(!points && !overhead) import earth/varying.wgsl;

// Vertex stage: how the mesh is made.
@if(blocks) import earth/vertex/block_lattice.wgsl;
@if(patches) import earth/vertex/relief_patches.wgsl;
@if(grid) import earth/vertex/projected_grid.wgsl;
@if(cast) import earth/vertex/contour_prisms.wgsl;

// Where a pixel looks: fn surface_point(in: Varying) -> SurfacePoint.
import earth/surface_point.wgsl;
@if(relief) import earth/surface_point/on_relief.wgsl;
@if(!relief && !points && !overhead) import earth/surface_point/ray_on_ellipsoid.wgsl;

// How maps are read there: fn sample_map(map, filtering, layer, at: SurfacePoint) -> vec4f.
@if(!geolocation) import earth/maps.wgsl;
@if(per_block_tiles) import earth/blocks.wgsl;

// How the ground leans: fn surface_normal(at: SurfacePoint) -> vec3f.
@if(!geolocation && !points && !overhead) import earth/surface_normal.wgsl;

// What it looks like: fn shade(at: SurfacePoint) -> vec3f.
@if(paper) import earth/shading/paper.wgsl;
@if(sunlit && !points && !overhead) import earth/shading/sunlit.wgsl;

// Fragment stage: what is written.
@if(!points && !overhead) import earth/fragment.wgsl;

// Both stages of what is drawn over it, and of clouds in the sky over an eye below them.
@if(points) import earth/city_lights.wgsl;
@if(overhead) import earth/clouds_overhead.wgsl;
