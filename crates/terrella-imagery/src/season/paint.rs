//! Colours of a texel of the ground with snow and ice.

/// Colour of snow on land, and of the sea's ice with its snow, sRGB.
const SNOW: [f32; 3] = [236.0, 239.0, 243.0];
pub(super) const ICE: [f32; 3] = [222.0, 230.0, 237.0];

/// Fraction of the snow that is seen from above in forests, and the brightness, sRGB, below which land of the day map is forest and above which it is
/// open. The taiga of the starter map has 22 to 35, farmland 40 to 80.
const SEEN_IN_FORESTS: f32 = 0.4;
const FORESTS: [f32; 2] = [26.0, 44.0];
/// Excess of green over red in the day map's summer, sRGB, from which land begins to lose its leaves in snow, and from which it loses all. The taiga
/// has 5 to 10, deciduous woods 16 to 20.
const LEAVES: [f32; 2] = [6.0, 18.0];
/// Land loses its leaves while the cover with snow rises to this.
const LEAFLESS: [f32; 2] = [0.0, 0.3];
/// What the excess of green adds to red, green and blue of leafless land: the browns and greys of bark and litter.
const BARK: [f32; 3] = [0.7, -0.35, 0.4];
/// Brightness below which bluish texels are water, sRGB.
const LAKES: f32 = 110.0;

/// Paints a texel of which this fraction is water.
pub(super) fn paint_texel(texel: &mut [u8; 4], water: f32, snow: f32, ice: f32) {
    let color = [texel[0], texel[1], texel[2]].map(f32::from);
    let brightness = color.iter().sum::<f32>() / 3.0;
    // Small lakes are land in the water map, with the day map's blue; so are islands that are smaller than its texels.
    let is_lake = color[2] > color[1] && brightness < LAKES;
    let forest = 1.0 - smooth(FORESTS, brightness);
    let white = match is_lake {
        true => ice,
        false => smooth([0.1, 0.9], snow) * (1.0 - forest * (1.0 - SEEN_IN_FORESTS)),
    };
    // The texel's colour is that of its land and its ice.
    let (land, ice) = (1.0 - water, water * ice);
    let shown = (land + ice).max(1e-3);
    let color = match is_lake {
        true => color,
        false => without_leaves(color, snow),
    };
    for (channel, code) in texel.iter_mut().take(3).enumerate() {
        let of_land = color[channel] + white * (SNOW[channel].max(color[channel]) - color[channel]);
        *code = ((land * of_land + ice * ICE[channel]) / shown + 0.5) as u8;
    }
}

/// The colour of land in a season with this cover of snow.
fn without_leaves(color: [f32; 3], snow: f32) -> [f32; 3] {
    let green = color[1] - color[0];
    let lost = smooth(LEAVES, green) * smooth(LEAFLESS, snow) * green;
    std::array::from_fn(|channel| color[channel] + BARK[channel] * lost)
}

pub(super) fn smooth([first, last]: [f32; 2], value: f32) -> f32 {
    let t = ((value - first) / (last - first)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forests_hide_snow_and_lakes_freeze_as_the_sea() {
        let painted_with = |color: [u8; 3], ice: f32| {
            let mut texel = [color[0], color[1], color[2], 7];
            paint_texel(&mut texel, 0.0, 1.0, ice);
            assert_eq!(texel[3], 7);
            texel[0]
        };
        let painted = |color| painted_with(color, 0.0);
        assert_eq!(painted([140, 140, 110]), SNOW[0] as u8);
        assert!((90..130).contains(&painted([25, 40, 15])));
        assert_eq!(painted([15, 25, 50]), 15);
        assert_eq!(painted_with([15, 25, 50], 1.0), SNOW[0] as u8);
        assert_eq!(painted([255, 255, 255]), 255);
    }

    #[test]
    fn woods_lose_their_leaves_and_the_taiga_does_not() {
        let painted = |color: [u8; 3], snow: f32| {
            let mut texel = [color[0], color[1], color[2], 255];
            paint_texel(&mut texel, 0.0, snow, 0.0);
            [texel[0], texel[1], texel[2]].map(i32::from)
        };
        // Woods of Pennsylvania with a little snow in the fields, and none.
        let [red, green, blue] = painted([30, 49, 14], 0.3);
        assert!(red >= green - 5 && green > blue, "{red} {green} {blue}");
        assert_eq!(painted([30, 49, 14], 0.0), [30, 49, 14]);
        let [red, green, _] = painted([29, 35, 14], 0.3);
        assert!(green > red, "{red} {green}");
    }
}
