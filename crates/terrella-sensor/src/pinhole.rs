//! The picture that a pinhole camera must give, so that a lens can be put in front of the sensor.

use crate::error::SensorError;
use crate::lens::PlaneRect;
use glam::DVec2;

/// A picture on the plane at unit focal length, of square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinholeFrame {
    /// The part of the plane that it shows: x right, y down.
    pub rect: PlaneRect,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// Additional pixels around the requested ones, for interpolation.
const MARGIN_PX: f64 = 3.0;

impl PinholeFrame {
    /// An image of at least a part of the plane, with this many pixels per unit. Pixel edges are where (x, y) · `scale` + `origin` is an integer.
    pub(crate) fn around(rect: PlaneRect, scale: f64, origin: DVec2) -> Self {
        let least = (rect.least * scale + origin).floor() - MARGIN_PX;
        let most = (rect.most * scale + origin).ceil() + MARGIN_PX;
        let size = most - least;
        Self {
            rect: PlaneRect {
                least: (least - origin) / scale,
                most: (most - origin) / scale,
            },
            size: [size.x as u32, size.y as u32],
        }
    }

    /// Pixels.
    pub fn len(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Whether it has no pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where a point of the plane is in the picture, pixels from its upper left corner.
    pub fn at(&self, direction: DVec2) -> DVec2 {
        let size = DVec2::from(self.size.map(f64::from));
        (direction - self.rect.least) / (self.rect.most - self.rect.least) * size
    }

    /// The pixel that holds a point of the plane, the nearest one for points beside the picture.
    pub fn pixel(&self, direction: DVec2) -> [u32; 2] {
        let size = DVec2::from(self.size.map(f64::from));
        let at = self.at(direction).floor().clamp(DVec2::ZERO, size - 1.0);
        [at.x as u32, at.y as u32]
    }
}

/// An image with its light: red, green, blue and an unused value, rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct PinholePicture<'p> {
    frame: PinholeFrame,
    light: &'p [[f32; 4]],
}

impl<'p> PinholePicture<'p> {
    /// # Errors
    /// Another number of pixels than the frame has.
    pub fn new(frame: PinholeFrame, light: &'p [[f32; 4]]) -> Result<Self, SensorError> {
        match light.len() == frame.len() {
            true => Ok(Self { frame, light }),
            false => Err(SensorError::PictureSize {
                found: light.len(),
                wanted: frame.len(),
            }),
        }
    }

    /// The light in a direction: of the middle of a pixel its own, between them the polynomial through six by six.
    pub(crate) fn light(&self, direction: DVec2) -> [f64; 3] {
        let at = self.frame.at(direction) - 0.5;
        // Rounding must not turn the middle of a pixel into a mixture.
        let near = at.round();
        let at = if (at - near).abs().max_element() < 1e-6 {
            near
        } else {
            at
        };
        let base = at.floor();
        let part = at - base;
        let [across, down] = [part.x, part.y].map(lagrange);
        let [width, height] = self.frame.size.map(i64::from);
        let (x, y) = (base.x as i64, base.y as i64);
        let mut light = [0.0; 3];
        for (j, weight_y) in (y - 2..).zip(down) {
            if weight_y == 0.0 {
                continue;
            }
            let row = j.clamp(0, height - 1) * width;
            for (i, weight_x) in (x - 2..).zip(across) {
                let weight = weight_x * weight_y;
                if weight == 0.0 {
                    continue;
                }
                let texel = self.light[(row + i.clamp(0, width - 1)) as usize];
                for (light, texel) in light.iter_mut().zip(texel) {
                    *light += weight * f64::from(texel);
                }
            }
        }
        // Beside a sharp limb the polynomial swings below 0.
        light.map(|light| light.max(0.0))
    }
}

/// Weights of the values at −2 … 3 for a place t of 0…1 between: Lagrange's polynomial of degree 5.
fn lagrange(t: f64) -> [f64; 6] {
    let mut weights = [1.0; 6];
    for (i, weight) in weights.iter_mut().enumerate() {
        for j in (0..6).filter(|j| *j != i) {
            *weight *= (t + 2.0 - j as f64) / (i as f64 - j as f64);
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_five_are_kept() {
        for t in [0.0, 0.3, 0.5, 0.99] {
            let weights = lagrange(t);
            let value = |x: f64| 1.0 + x * (0.5 + x * (-0.25 + x * (0.1 + x * (0.02 - 0.01 * x))));
            let found: f64 = (-2..4)
                .zip(weights)
                .map(|(x, w)| w * value(f64::from(x)))
                .sum();
            assert!((found - value(t)).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn the_middle_of_a_pixel_is_the_pixel() {
        let rect = PlaneRect {
            least: DVec2::new(-0.4, -0.3),
            most: DVec2::new(0.4, 0.3),
        };
        let frame = PinholeFrame::around(rect, 10.0, DVec2::new(3.0, 5.0));
        assert_eq!(frame.size, [14, 12]);
        let light: Vec<_> = (0..frame.len())
            .map(|i| [i as f32, 1.0, 0.0, 0.0])
            .collect();
        let picture = PinholePicture::new(frame, &light).expect("fits");
        assert_eq!(
            picture.light(DVec2::new(0.05, -0.15))[0],
            f64::from(4_u8 * 14 + 7)
        );
        assert_eq!(frame.pixel(DVec2::new(0.05, -0.15)), [7, 4]);
        PinholePicture::new(frame, &light[1..]).expect_err("one short");
    }
}
