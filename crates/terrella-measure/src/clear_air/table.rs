//! Rows of the tables.

use std::path::{Path, PathBuf};

/// Which air a table is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AirSet {
    /// Set A: molecules and ozone.
    Clear,
    /// Set B: the same with haze of optical depth 0.1 at 550 nm.
    Haze,
}

impl AirSet {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Clear, Self::Haze];

    /// The letter in the files' names.
    pub fn letter(self) -> char {
        match self {
            Self::Clear => 'A',
            Self::Haze => 'B',
        }
    }

    /// Optical depth of its aerosol at 550 nm.
    pub fn aerosol_optical_depth(self) -> f64 {
        match self {
            Self::Clear => 0.0,
            Self::Haze => 0.1,
        }
    }
}

/// Kind of a table's views.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AirTable {
    /// The ground, from 400 km.
    Nadir,
    /// Past the Earth's edge, from 400 km.
    Limb,
    /// The sky, from inside the air.
    Sky,
    /// Level ground from close by: the light that falls on it.
    Ground,
}

impl AirTable {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Nadir, Self::Limb, Self::Sky, Self::Ground];

    /// The beginning of the files' names.
    fn file(self) -> &'static str {
        match self {
            Self::Nadir => "nadir",
            Self::Limb => "limb",
            Self::Sky => "sky",
            Self::Ground => "irradiance",
        }
    }
}

/// One view and its true radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirRow {
    /// Kind of the view.
    pub table: AirTable,
    /// Zenith angle of the Sun at the point that the view is given by, degrees: the point on the ground, the tangent point,
    /// the eye in the air.
    pub sun_zenith_deg: f64,
    /// Azimuth of the line of sight, degrees: 0 looks towards the Sun's side of the horizon.
    pub azimuth_deg: f64,
    /// Zenith angle of the line of sight, degrees: of the eye seen from the ground, or of the direction of view from an eye in the air. For
    /// [`AirTable::Limb`] the tangent height instead, kilometres; negative below the ground.
    pub place: f64,
    /// Height of the eye, kilometres.
    pub eye_km: f64,
    /// Reflectance of the ground, everywhere and at all wavelengths.
    pub albedo: f64,
    /// Light: 1 is a white sheet that faces the Sun in space. Linear sRGB with the Sun as white.
    pub light: [f64; 3],
    /// Increase per albedo.
    pub albedo_slope: [f64; 3],
}

impl AirRow {
    /// Whether it is the same view as another, whatever the ground's albedo.
    fn is_same_view(&self, other: &Self) -> bool {
        let of = |row: &Self| {
            let Self {
                sun_zenith_deg,
                azimuth_deg,
                place,
                eye_km,
                ..
            } = *row;
            [sun_zenith_deg, azimuth_deg, place, eye_km]
        };
        of(self) == of(other)
    }

    /// The light over ground of a slightly different albedo.
    pub fn light_over(&self, albedo: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| self.light[i] + self.albedo_slope[i] * (albedo - self.albedo))
    }

    /// Whether the table is reliable in a channel: 0 is red.
    ///
    /// Below 6 km, towards a Sun on or below the horizon, the blue is almost entirely multiply scattered light (93 % at 440 nm). The program that
    /// made the tables computes this light without the Earth's shadow. Its authors left out rows where it is more than half of the luminance, but
    /// not by channel. Their Monte Carlo program gives 2.90e-3 ± 0.02e-3 for the table's 3.43e-3 there (440 nm, 5 km, Sun at 90°) and 2.38e-4 ±
    /// 0.06e-4 for 3.22e-4 (93°).
    pub fn is_sure(&self, channel: usize) -> bool {
        let is_towards_sun = self.sun_zenith_deg >= 90.0 && self.azimuth_deg < 90.0;
        let is_low = self.table == AirTable::Limb && (0.0..6.0).contains(&self.place);
        channel != 2 || !(is_low && is_towards_sun)
    }

    /// Description of the view.
    pub fn name(&self) -> String {
        let place = match self.table {
            AirTable::Nadir => format!("ground under {}° from 400 km", self.place),
            AirTable::Limb => format!("limb at {} km from 400 km", self.place),
            AirTable::Sky => format!("sky at {}° from {} km", self.place, self.eye_km),
            AirTable::Ground => "ground from close by".to_owned(),
        };
        format!(
            "{place}, Sun {}°, azimuth {}°, albedo {}",
            self.sun_zenith_deg, self.azimuth_deg, self.albedo
        )
    }
}

/// Why a table could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The file.
    #[error("the table {path} cannot be read: {source}")]
    Read { path: PathBuf, source: csv::Error },
    /// A column that is needed.
    #[error("the table {path} has no column \"{column}\"")]
    Column { path: PathBuf, column: String },
    /// A value.
    #[error("the table {path} has no number in column \"{column}\" of row {row}")]
    Number {
        path: PathBuf,
        column: String,
        /// Which row, the first below the head being 1.
        row: usize,
    },
}

/// Reads the scalar columns of a table in `folder`.
///
/// The light of [`AirTable::Ground`] is that of ground with the row's albedo under the irradiance of the table.
///
/// # Errors
/// A file that cannot be read or lacks a column or number.
pub fn read_table(folder: &Path, table: AirTable, set: AirSet) -> Result<Vec<AirRow>, TableError> {
    let path = folder.join(format!("{}_{}.csv", table.file(), set.letter()));
    let failed = |source| TableError::Read {
        path: path.clone(),
        source,
    };
    let mut reader = csv::Reader::from_path(&path).map_err(failed)?;
    let head = reader.headers().map_err(failed)?.clone();
    let mut rows: Vec<AirRow> = Vec::new();
    for (at, record) in reader.records().enumerate() {
        let record = record.map_err(failed)?;
        let number = |column: &str| -> Result<f64, TableError> {
            let index = head.iter().position(|name| name == column);
            let index = index.ok_or_else(|| TableError::Column {
                path: path.clone(),
                column: column.into(),
            })?;
            let value = record.get(index).and_then(|text| text.parse().ok());
            value.ok_or_else(|| TableError::Number {
                path: path.clone(),
                column: column.into(),
                row: at + 1,
            })
        };
        let light = |prefix: &str, suffix: &str| -> Result<[f64; 3], TableError> {
            let channel = |name: &str| number(&format!("{prefix}{name}{suffix}"));
            Ok([channel("r")?, channel("g")?, channel("b")?])
        };
        let albedo = number("albedo")?;
        let (azimuth_deg, place, eye_km, light) = match table {
            AirTable::Nadir => {
                let light = light("", "_scalar")?;
                (number("rel_azimuth")?, number("view_zenith")?, 400.0, light)
            }
            AirTable::Limb => {
                let light = light("", "_scalar")?;
                (number("rel_azimuth")?, number("tangent_km")?, 400.0, light)
            }
            AirTable::Sky => {
                let light = light("", "_scalar")?;
                (
                    number("rel_azimuth")?,
                    number("view_zenith")?,
                    number("eye_km")?,
                    light,
                )
            }
            AirTable::Ground => {
                let (direct, diffuse) = (light("direct_", "")?, light("diffuse_", "_scalar")?);
                (
                    0.0,
                    0.0,
                    0.0,
                    [0, 1, 2].map(|i| (direct[i] + diffuse[i]) * albedo),
                )
            }
        };
        rows.push(AirRow {
            table,
            sun_zenith_deg: number("sun_zenith")?,
            azimuth_deg,
            place,
            eye_km,
            albedo,
            light,
            albedo_slope: [0.0; 3],
        });
    }
    let slopes: Vec<_> = rows.iter().map(|row| albedo_slope(row, &rows)).collect();
    for (row, slope) in rows.iter_mut().zip(slopes) {
        row.albedo_slope = slope;
    }
    Ok(rows)
}

/// From the same view over the ground with the nearest albedo.
fn albedo_slope(row: &AirRow, rows: &[AirRow]) -> [f64; 3] {
    let others = rows
        .iter()
        .filter(|other| row.is_same_view(other) && other.albedo != row.albedo);
    let apart = |other: &AirRow| (other.albedo - row.albedo).abs();
    let Some(other) = others.min_by(|a, b| apart(a).total_cmp(&apart(b))) else {
        return [0.0; 3];
    };
    [0, 1, 2].map(|i| (other.light[i] - row.light[i]) / (other.albedo - row.albedo))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NADIR: &str = "sun_zenith,view_zenith,rel_azimuth,albedo,r_scalar,g_scalar,b_scalar\n\
        30,60,90,0.05,0.1,0.2,0.3\n30,60,90,0.3,0.2,0.35,0.4\n30,70,90,0.3,0.5,0.5,0.5\n";

    fn written(name: &str, text: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join(name), text).expect("writes");
        folder
    }

    #[test]
    fn rows_are_read_with_what_the_albedo_does() {
        let folder = written("nadir_A.csv", NADIR);
        let rows = read_table(folder.path(), AirTable::Nadir, AirSet::Clear).expect("a table");
        assert_eq!(rows.len(), 3);
        assert_eq!(
            (rows[0].place, rows[0].eye_km, rows[0].albedo),
            (60.0, 400.0, 0.05)
        );
        let over = rows[0].light_over(0.06);
        for (found, wanted) in over.into_iter().zip([0.104, 0.206, 0.304]) {
            assert!((found - wanted).abs() < 1e-12, "{over:?}");
        }
        assert_eq!(rows[2].albedo_slope, [0.0; 3]);
    }

    #[test]
    fn ground_is_as_bright_as_its_light_and_albedo() {
        let text = "sun_zenith,albedo,direct_r,direct_g,direct_b,diffuse_r_scalar,diffuse_g_scalar,diffuse_b_scalar\n\
            60,0.5,0.4,0.3,0.2,0.1,0.2,0.3\n";
        let folder = written("irradiance_B.csv", text);
        let rows = read_table(folder.path(), AirTable::Ground, AirSet::Haze).expect("a table");
        assert_eq!(rows[0].light, [0.25; 3]);
    }

    #[test]
    fn what_is_missing_is_named() {
        let read = |text: &str| {
            let folder = written("nadir_A.csv", text);
            let rejected = read_table(folder.path(), AirTable::Nadir, AirSet::Clear);
            rejected.expect_err("nothing to read").to_string()
        };
        assert!(read("albedo,r_scalar,g_scalar\n0,1,1\n").contains("\"b_scalar\""));
        assert!(read(&NADIR.replace("0.35", "none")).contains("row 2"));
        let folder = tempfile::tempdir().expect("a folder");
        let rejected = read_table(folder.path(), AirTable::Sky, AirSet::Haze);
        assert!(
            rejected
                .expect_err("no file")
                .to_string()
                .contains("sky_B.csv")
        );
    }
}
