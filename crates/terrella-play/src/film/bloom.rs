//! Light that a lens scatters, on the processor: as `terrella::Bloom` does it, for films whose light is gathered first.

use glam::DVec3;
use rayon::prelude::*;
use terrella::Bloom;

/// A picture of light, rows from the top.
struct Grid {
    width: usize,
    height: usize,
    light: Vec<DVec3>,
}

/// Scatters exposed light in place; the fourth number of pixels stays. Rows from the top.
pub fn scatter(bloom: &Bloom, size: (u32, u32), pixels: &mut [[f32; 4]], factor: f64) {
    let shares = bloom.shares(size);
    let Some(first) = shares.first().filter(|_| factor > 0.0) else {
        return;
    };
    let brightest = DVec3::splat(Bloom::BRIGHTEST_SCATTERED / factor);
    let light = pixels.iter().map(|&[red, green, blue, _]| {
        let light = DVec3::new(red.into(), green.into(), blue.into());
        light.min(brightest)
    });
    let (width, height) = (size.0 as usize, size.1 as usize);
    let light = Grid {
        width,
        height,
        light: light.collect(),
    };
    let mut levels: Vec<Grid> = Vec::with_capacity(shares.len());
    for _ in &shares {
        levels.push(levels.last().unwrap_or(&light).coarser());
    }
    let Some(coarsest) = levels.pop() else {
        return;
    };
    let finer_levels = levels.into_iter().zip(&shares[1..]).rev();
    let scattered = finer_levels.fold(coarsest, |coarser, (level, share)| {
        level.mixed(&coarser, *share)
    });
    pixels
        .par_iter_mut()
        .enumerate()
        .for_each(|(index, pixel)| {
            let light = scattered.finer(index % width, index / width);
            for (channel, scattered) in pixel.iter_mut().zip(light.to_array()) {
                *channel = (f64::from(*channel) * (1.0 - first) + scattered * first) as f32;
            }
        });
}

impl Grid {
    /// Half as large.
    fn coarser(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let light = (0..width * height).into_par_iter().map(|index| {
            let (x, y) = ((index % width) as isize, (index / width) as isize);
            let weights = [1.0, 3.0, 3.0, 1.0];
            let mut sum = DVec3::ZERO;
            for (row, down) in weights.iter().enumerate() {
                for (column, across) in weights.iter().enumerate() {
                    let (x, y) = (2 * x - 1 + column as isize, 2 * y - 1 + row as isize);
                    sum += down * across * self.at(x, y);
                }
            }
            sum / 64.0
        });
        Self {
            width,
            height,
            light: light.collect(),
        }
    }

    /// Value at a pixel of an image twice as large: interpolated at that pixel's centre.
    fn finer(&self, x: usize, y: usize) -> DVec3 {
        let taps = |index: usize| {
            let middle = (index / 2) as isize;
            match index % 2 {
                0 => [(middle - 1, 0.25), (middle, 0.75)],
                _ => [(middle, 0.75), (middle + 1, 0.25)],
            }
        };
        let mut sum = DVec3::ZERO;
        for (y, down) in taps(y) {
            for (x, across) in taps(x) {
                sum += down * across * self.at(x, y);
            }
        }
        sum
    }

    /// Blended with a coarser level by `share`.
    fn mixed(mut self, coarser: &Self, share: f64) -> Self {
        let width = self.width;
        let light = self.light.par_iter_mut().enumerate();
        light.for_each(|(index, light)| {
            *light = light.lerp(coarser.finer(index % width, index / width), share);
        });
        self
    }

    /// The nearest pixel's beyond the edges.
    fn at(&self, x: isize, y: isize) -> DVec3 {
        let inside = |place: isize, count: usize| place.clamp(0, count as isize - 1) as usize;
        self.light[inside(y, self.height) * self.width + inside(x, self.width)]
    }
}
