//! Gauss–Legendre nodes and weights on −1…1 (Abramowitz and Stegun, table 25.4).

/// Eight nodes.
pub(super) fn gauss_legendre_8() -> [(f64, f64); 8] {
    mirrored([
        (0.183_434_642_495_650, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887),
        (0.796_666_477_413_627, 0.222_381_034_453_374),
        (0.960_289_856_497_536, 0.101_228_536_290_376),
    ])
}

/// Ten nodes.
pub(super) fn gauss_legendre_10() -> [(f64, f64); 10] {
    mirrored([
        (0.148_874_338_981_631, 0.295_524_224_714_753),
        (0.433_395_394_129_247, 0.269_266_719_309_996),
        (0.679_409_568_299_024, 0.219_086_362_515_982),
        (0.865_063_366_688_985, 0.149_451_349_150_581),
        (0.973_906_528_517_172, 0.066_671_344_308_688),
    ])
}

fn mirrored<const HALF: usize, const ALL: usize>(half: [(f64, f64); HALF]) -> [(f64, f64); ALL] {
    std::array::from_fn(|n| match n < HALF {
        true => (-half[HALF - 1 - n].0, half[HALF - 1 - n].1),
        false => half[n - HALF],
    })
}
