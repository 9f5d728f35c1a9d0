//! Constants of the propagators, each with its source.

/// GM of the Earth with its air, m³/s²: EGM96 (Lemoine et al. 1998, NASA/TP-1998-206861), the value that goes with
/// terrestrial time (IERS Conventions 2010, 1.1).
pub const EARTH_GM_M3_S2: f64 = 3.986_004_415e14;
/// The radius that EGM96's coefficients go with, metres.
pub const EGM96_EQUATORIAL_RADIUS_M: f64 = 6_378_136.3;
/// J2 of EGM96: −√5 C̄20, tide-free.
pub const EGM96_J2: f64 = 1.082_626_683_553_151_3e-3;
/// GM of the Sun, m³/s² (IAU 2015 resolution B3, nominal).
pub const SUN_GM_M3_S2: f64 = 1.327_124_4e20;
/// GM of the Moon, m³/s²: the Earth's over 81.300 568 (DE421 and later; Folkner, Williams & Boggs 2009).
pub const MOON_GM_M3_S2: f64 = 4.902_800e12;
/// Pressure of sunlight on a perfect absorber at one astronomical unit, N/m²: 1361 W/m² (IAU 2015 resolution B3) over the speed of light.
pub const SUNLIGHT_PRESSURE_N_M2: f64 = 1361.0 / 299_792_458.0;
