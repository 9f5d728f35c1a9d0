//! The air with light of all orders of scattering.

use super::air::{Air, Scattered};
use super::field::{BySun, Field, Grid};
use super::matter::Matter;
use super::orders::Solver;
use super::spectrum::BANDS;

/// Makes an air ready, with light that is scattered any number of times, on all cores; takes seconds.
pub(super) fn air_of_all_orders(matter: Matter, radius_m: f64) -> Air {
    let mut air = Air::without_orders(matter, radius_m);
    let grid = Grid::new(air.top - 1.0);
    let solver = Solver::new(&air, &grid);
    let sun = solver.of_sun();
    air.scattered = Some(Scattered {
        sun,
        ground: Field::none(&grid),
        sky_albedo: Solver::sky_albedo(&air),
        sky: BySun::fill(&grid, |_| [0.0; BANDS]),
        grid: grid.clone(),
    });
    let sky = BySun::fill(&grid, |mu| air.skylight(mu));
    let ground = Solver::new(&air, &grid).of_ground(|mu| {
        let (direct, sky) = (air.sunlight(0.0, mu), sky.at(mu));
        std::array::from_fn(|i| direct[i] * mu.max(0.0) + sky[i])
    });
    if let Some(scattered) = &mut air.scattered {
        (scattered.ground, scattered.sky) = (ground, sky);
    }
    air
}
