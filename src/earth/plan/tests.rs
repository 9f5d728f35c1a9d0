//! Plans of frames, without a GPU.

use super::*;
use crate::earth::{EyeView, Viewport};
use terrella_frames::Geodetic;
use terrella_ground::globe::{BlockRow, TangentCone};
use terrella_imagery::{EarthLayers, LayerImage};

const SKY: Sky = Sky::new(DVec3::X);

const LIMITS: DeviceLimits = DeviceLimits {
    texture_side: 8192,
    uniform_bytes: 1 << 16,
    storage_bytes: 1 << 27,
    bindings: 1000,
};

fn planner() -> Planner {
    planner_of(Subdivision::Auto)
}

fn planner_of(subdivision: Subdivision) -> Planner {
    let mut options = EarthOptions::new(EarthLayers {
        day: LayerImage::from_rgba8(1, 1, vec![0; 4]).expect("a map"),
        clouds: None,
        normals: None,
        night_lights: None,
        water: None,
    });
    options.subdivision = subdivision;
    let quality = Quality::of(&options);
    Planner::new(&options, &quality, &LIMITS).expect("good options")
}

fn nadir(lat_deg: f64, lon_deg: f64, height_m: f64) -> ItrfView {
    let place = Geodetic::from_degrees(lat_deg, lon_deg, height_m);
    let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
    let view = EyeView::itrf(eye, -eye, DVec3::Z, 0.8, 1.6);
    view.in_itrf(Viewport::from((640, 400))).expect("a picture")
}

#[test]
fn a_plan_holds_what_is_drawn_and_no_gpu_was_asked() {
    let mut planner = planner();
    let mut plan = planner.empty_plan();
    let view = nadir(10.0, 20.0, 4e5);
    let stats = planner.plan(&view, &SKY, &mut plan);
    let grid = planner.meshes().grid();
    assert!(!plan.blocks.is_empty());
    assert_eq!(stats.blocks_drawn as usize, plan.blocks.len());
    assert_eq!(
        planner.meshes().grids()[plan.mesh].subdivision(),
        stats.subdivision
    );
    let per_block = grid.vertices_per_block() as usize;
    assert_eq!(plan.vertices.len(), plan.blocks.len() * per_block);
    for (n, block) in plan.blocks.iter().enumerate() {
        let cone = TangentCone::new(view.eye_itrf_m, &grid.ellipsoid());
        let first = cone.lifted(grid.vertex_row(*block, 0)[0]) - view.eye_itrf_m;
        assert_eq!(plan.vertices[n * per_block], first.as_vec3());
    }
    assert!(plan.air.is_some());
    // The Sun is above 0° E, and the whole view is in daylight.
    assert_eq!(plan.daylit.len(), stats.blocks_drawn);
    let dusk = Sky::new(
        DVec3::new(20_f64.to_radians().cos(), 20_f64.to_radians().sin(), 0.0).cross(DVec3::Z),
    );
    let mut other = planner.empty_plan();
    planner.plan(&view, &dusk, &mut other);
    assert!(other.daylit.len() < plan.daylit.len());
    assert_eq!(plan.uniforms.sun_itrf, SKY.sun_itrf.as_vec3());
    plan.clear();
    assert!(plan.blocks.is_empty() && plan.vertices.is_empty() && plan.air.is_none());
}

#[test]
fn draws_and_their_costs_are_those_of_the_plan() {
    let mut planner = planner();
    // Each block whole.
    planner.interpolates = false;
    let mut plan = planner.empty_plan();
    let mut stats = planner.plan(&nadir(80.0, 20.0, 4e5), &SKY, &mut plan);
    planner.list_draws(None, &mut plan, &mut stats);
    assert!(
        plan.draws
            .iter()
            .map(|draw| draw.block)
            .eq(plan.blocks.iter().map(|b| Some(*b)))
    );
    let grid = planner.meshes().grid();
    let triangles = plan.blocks.iter().map(|block| grid.triangles(block.kind()));
    let ring = plan.air.expect("air").ring.triangles();
    assert_eq!(stats.triangles, triangles.sum::<u32>() + ring);
    assert_eq!(stats.draw_calls, stats.blocks_drawn + 1);
    // The three kinds of blocks follow each other in one list.
    let kinds = [BlockRow::North, BlockRow::Middle].map(|kind| 3 * grid.triangles(kind));
    for draw in &plan.draws {
        let start = match draw.block.map(Block::kind) {
            Some(BlockRow::North) => 0,
            Some(BlockRow::Middle) => kinds[0],
            _ => kinds[0] + kinds[1],
        };
        assert_eq!(draw.indices.start, start);
    }
}

/// The triangles of a plan, with indices into all of the plan's vertices, and their lighting.
fn triangles(planner: &Planner, plan: &FramePlan) -> Vec<([u32; 3], DrawLight)> {
    let grid = planner.meshes().grid();
    let kinds = [BlockRow::North, BlockRow::Middle, BlockRow::South];
    let whole = kinds.map(|kind| grid.indices(kind)).concat();
    let mut triangles = Vec::new();
    for draw in &plan.draws {
        let list = if draw.is_listed { &plan.cells } else { &whole };
        let range = draw.indices.start as usize..draw.indices.end as usize;
        let base = draw.patch as u32 * grid.vertices_per_block();
        triangles.extend(list[range].as_chunks::<3>().0.iter().map(|corners| {
            let corners = corners.map(|corner| base + u32::from(corner));
            (corners, draw.light)
        }));
    }
    triangles
}

#[test]
fn every_cell_is_drawn_once_and_by_what_light_its_place_needs() {
    let mut planner = planner();
    for (view, interpolates) in [
        (nadir(80.0, 20.0, 6e5), true),
        (nadir(0.0, 0.0, 2e6), true),
        // The Sun is too low for cells of this size; then the night side, inside the air, far away.
        (nadir(-60.0, 5.0, 7e6), false),
        (nadir(0.0, 180.0, 6e5), false),
        (nadir(0.0, 0.0, 5e4), false),
        (nadir(0.0, 0.0, 3e8), false),
    ] {
        let mut plan = planner.empty_plan();
        let mut stats = planner.plan(&view, &SKY, &mut plan);
        planner.list_draws(None, &mut plan, &mut stats);
        let mut drawn = triangles(&planner, &plan);
        let mut whole = plan;
        whole.draws.clear();
        draw_blocks(planner.meshes().grid(), &whole.blocks, &mut whole.draws);
        let mut all = triangles(&planner, &whole);
        let is_any = drawn
            .iter()
            .any(|(_, light)| *light == DrawLight::Interpolated);
        assert_eq!(is_any, interpolates, "{:?}", view.eye_itrf_m);
        let in_deep_night = view.eye_itrf_m.normalize().dot(SKY.sun_itrf) < -0.9;
        let has_night = drawn.iter().any(|(_, light)| *light == DrawLight::Night);
        assert_eq!(has_night, in_deep_night, "{:?}", view.eye_itrf_m);
        for (corners, light) in &drawn {
            for corner in corners {
                let from_eye_m = whole.vertices[*corner as usize].as_dvec3();
                let up = (view.eye_itrf_m + from_eye_m).normalize();
                let by_day = up.dot(SKY.sun_itrf) > 0.0;
                let is_limb = up.dot(-from_eye_m.normalize()) < 0.02;
                let is_dark = up.dot(SKY.sun_itrf) < DEEP_NIGHT;
                let by_night = [DrawLight::Everything, DrawLight::Night];
                assert!(by_day || by_night.contains(light));
                assert!(is_dark || *light != DrawLight::Night);
                assert!(!is_limb || *light != DrawLight::Interpolated);
            }
        }
        drawn.sort_unstable();
        all.sort_unstable();
        let corners = |list: &[([u32; 3], DrawLight)]| list.iter().map(|t| t.0).collect::<Vec<_>>();
        assert_eq!(corners(&drawn), corners(&all));
    }
}

/// A block at a pole has an odd number of triangles where its side has an odd number of cells.
#[test]
fn listed_cells_are_written_four_bytes_at_a_time() {
    let mut is_listed = false;
    for cells in [5, 7, 47] {
        let mut planner = planner_of(Subdivision::Cells(cells));
        let mut plan = planner.empty_plan();
        let mut stats = planner.plan(&nadir(80.0, 85.0, 3e6), &SKY, &mut plan);
        planner.list_draws(None, &mut plan, &mut stats);
        is_listed |= !plan.cells.is_empty();
        assert!(plan.cells.len().is_multiple_of(2), "{cells}");
    }
    assert!(is_listed);
}

#[test]
fn a_plan_has_room_for_every_view_from_the_start() {
    let mut planner = planner();
    let mut plan = planner.empty_plan();
    let room = |plan: &FramePlan| {
        let lists = (plan.draws.capacity(), plan.cells.capacity());
        (plan.blocks.capacity(), plan.vertices.capacity(), lists)
    };
    let before = room(&plan);
    for height_m in [1.0, 1e3, 1e5, 1e7, 1e9] {
        for lon_deg in [-180.0, -70.0, 0.0, 99.0] {
            let mut stats = planner.plan(&nadir(lon_deg / 2.0, lon_deg, height_m), &SKY, &mut plan);
            planner.list_draws(None, &mut plan, &mut stats);
        }
    }
    assert_eq!(room(&plan), before);
}
