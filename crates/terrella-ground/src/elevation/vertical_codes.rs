//! Codes of vertical systems, from the EPSG registry as PROJ 9.5.1 lists it.

/// Geographic systems with height above their ellipsoid, which is that of WGS84 to a few metres.
const WITH_HEIGHT: [u16; 209] = [
    3823, 3888, 4017, 4040, 4074, 4080, 4466, 4469, 4480, 4482, 4557, 4883, 4885, 4887, 4889, 4893,
    4895, 4898, 4907, 4909, 4921, 4923, 4925, 4927, 4929, 4931, 4933, 4935, 4937, 4939, 4941, 4943,
    4945, 4947, 4949, 4951, 4953, 4955, 4957, 4959, 4961, 4963, 4965, 4967, 4971, 4975, 4977, 4979,
    4981, 4983, 4985, 4987, 4989, 4997, 4999, 5012, 5245, 5251, 5263, 5323, 5342, 5353, 5359, 5364,
    5370, 5372, 5380, 5392, 5488, 5545, 5592, 5885, 6134, 6310, 6319, 6321, 6324, 6364, 6667, 6705,
    6782, 6982, 6989, 7034, 7036, 7038, 7040, 7042, 7072, 7085, 7087, 7135, 7138, 7372, 7657, 7659,
    7661, 7663, 7665, 7678, 7680, 7682, 7685, 7797, 7816, 7843, 7880, 7885, 7900, 7901, 7902, 7903,
    7904, 7905, 7906, 7907, 7908, 7909, 7910, 7911, 7912, 7915, 7917, 7919, 7921, 7923, 7925, 7927,
    7929, 7931, 8085, 8231, 8235, 8239, 8244, 8248, 8251, 8254, 8399, 8403, 8426, 8430, 8542, 8544,
    8684, 8698, 8817, 8899, 8901, 8906, 8916, 8918, 8920, 8922, 8924, 8926, 8928, 8930, 8932, 8934,
    8936, 8938, 8940, 8942, 8944, 8946, 8948, 9002, 9005, 9008, 9011, 9013, 9016, 9018, 9071, 9074,
    9139, 9147, 9152, 9293, 9308, 9332, 9379, 9469, 9546, 9695, 9701, 9754, 9776, 9778, 9781, 9783,
    9989, 10177, 10283, 10298, 10300, 10304, 10309, 10311, 10327, 10413, 10474, 10570, 10605,
    10670, 10672, 20040, 20045,
];

/// Systems of depths, which grow downwards.
const DEPTHS: [u16; 52] = [
    5336, 5612, 5614, 5706, 5715, 5734, 5739, 5789, 5831, 5861, 5862, 5863, 5864, 5865, 5866, 5867,
    5873, 6357, 6358, 6359, 7976, 8051, 8053, 8358, 8378, 8897, 9287, 9288, 9672, 10150, 10151,
    10349, 10364, 10370, 10371, 10372, 10373, 10374, 10375, 10376, 10377, 10378, 10379, 10547,
    10548, 10549, 10550, 10551, 10552, 10649, 10650, 10678,
];

/// Systems of heights in feet.
const FEET: [u16; 5] = [6130, 6131, 6132, 8050, 8228];

/// Systems of heights in US survey feet.
const US_SURVEY_FEET: [u16; 3] = [5702, 6360, 8052];

/// Whether a geographic system has heights above its ellipsoid.
pub fn has_height(code: u32) -> bool {
    is_in(&WITH_HEIGHT, code)
}

/// Whether the numbers of a vertical system grow downwards.
pub fn is_of_depths(code: u32) -> bool {
    is_in(&DEPTHS, code)
}

/// Whether the heights of a vertical system are in feet.
pub fn is_in_feet(code: u32) -> bool {
    is_in(&FEET, code)
}

/// Whether the heights of a vertical system are in US survey feet.
pub fn is_in_us_survey_feet(code: u32) -> bool {
    is_in(&US_SURVEY_FEET, code)
}

fn is_in(codes: &[u16], code: u32) -> bool {
    u16::try_from(code).is_ok_and(|code| codes.binary_search(&code).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_in_order() {
        for codes in [
            WITH_HEIGHT.as_slice(),
            DEPTHS.as_slice(),
            FEET.as_slice(),
            US_SURVEY_FEET.as_slice(),
        ] {
            assert!(codes.is_sorted_by(|one, next| one < next));
        }
        assert!(has_height(4979) && has_height(4937) && !has_height(4326));
        assert!(is_of_depths(5715) && !is_of_depths(5714));
    }
}
