//! The colours of a piece scaled to those of the layer beneath it.

use super::compose::Composer;
use super::piece::Piece;
use super::target::Target;
use super::texels::TexelKind;
use crate::error::BuildError;
use crate::source::SourceLimits;
use std::path::Path;

/// Texels round the Earth of the grid that means are taken on.
const GRID: u32 = 1024;

/// Factors beyond this and below its inverse are not taken: clouds over land are no matter of colour balance.
const MOST_GAIN: f64 = 4.0;

/// Sets the factors of all pieces that are matched, from the lowest up. Returns a note for each.
pub(super) fn match_pieces(
    pieces: &mut [Piece],
    kind: TexelKind,
    description: &Path,
    limits: SourceLimits,
) -> Result<Vec<String>, BuildError> {
    let mut notes = Vec::new();
    for n in 0..pieces.len() {
        if !pieces[n].part.is_matched {
            continue;
        }
        let means = means(&pieces[..n], &pieces[n..=n], kind, description, limits)?;
        let name = pieces[n].part.from.name().display().to_string();
        let Some([below, own]) = means else {
            notes.push(format!(
                "{name}: has nothing below it, so its colours stay as they are"
            ));
            continue;
        };
        let gains: Vec<f64> = (0..kind.channels)
            .map(|channel| below[channel] / own[channel].max(1e-9))
            .map(|gain| gain.clamp(1.0 / MOST_GAIN, MOST_GAIN))
            .collect();
        for (gain, found) in pieces[n].gains.iter_mut().zip(&gains) {
            *gain = *found as f32;
        }
        let texts: Vec<_> = gains.iter().map(|gain| format!("{gain:.3}")).collect();
        notes.push(format!(
            "{name}: light times {} to match what lies below",
            texts.join(", ")
        ));
    }
    Ok(notes)
}

/// Mean values where both exist: of the layer beneath, and of the piece.
fn means(
    below: &[Piece],
    own: &[Piece],
    kind: TexelKind,
    description: &Path,
    limits: SourceLimits,
) -> Result<Option<[[f64; 3]; 2]>, BuildError> {
    let target = Target::earth(GRID);
    let mut below = Composer::new(
        below.to_vec(),
        target,
        kind,
        description.to_path_buf(),
        limits,
    );
    let mut own = Composer::new(
        own.to_vec(),
        target,
        kind,
        description.to_path_buf(),
        limits,
    );
    let (mut sums, mut area) = ([[0.0; 3]; 2], 0.0);
    for row in 0..target.rows {
        own.row(row)?;
        if own.weights.iter().all(|weight| *weight < 0.5) {
            continue;
        }
        below.row(row)?;
        let latitude_deg = target.latitude_deg(row) - 0.5 * target.texel_deg;
        let part = latitude_deg.to_radians().cos();
        for x in 0..target.columns as usize {
            if own.weights[x] < 0.5 || below.weights[x] < 0.5 {
                continue;
            }
            area += part;
            for (sum, values) in sums.iter_mut().zip([&below.values, &own.values]) {
                for (channel, sum) in sum.iter_mut().enumerate().take(kind.channels) {
                    *sum += part * f64::from(values[x * kind.channels + channel]);
                }
            }
        }
    }
    let means = sums.map(|sums| sums.map(|sum| sum / area));
    Ok((area > 0.0).then_some(means))
}
