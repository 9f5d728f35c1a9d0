//! A frame: its components, their blocks, and which bits of them have come.

use super::Fault;

/// A picture's frame.
pub(super) struct Frame {
    pub height: u32,
    pub is_progressive: bool,
    pub components: Vec<Component>,
    /// Coding units of a scan of several components.
    pub units: (u32, u32),
    /// Largest sampling factors.
    pub most: (u32, u32),
}

/// A component of a frame.
pub(super) struct Component {
    pub id: u8,
    /// Blocks of a coding unit, across and down.
    pub sampling: (u32, u32),
    /// Blocks that a scan of this component alone has.
    pub blocks: (u32, u32),
    /// Blocks of a row, those that fill the last coding unit included.
    pub stride: u32,
    /// Of each coefficient, how many low bits have not come yet; `None` before its first scan.
    low_bits: [Option<u8>; 64],
    /// Of each block of a progressive picture, which coefficients are not zero.
    pub nonzero: Vec<u64>,
}

/// Coefficients and bits that a scan brings.
#[derive(Clone, Copy)]
pub(super) struct Band {
    pub first: u8,
    pub last: u8,
    /// Low bits that had not come before it; 0 in the first scan of these coefficients.
    pub high: u8,
    /// Low bits that have not come after it.
    pub low: u8,
}

impl Band {
    /// Content of a scan of a sequential image.
    pub const ALL: Self = Self {
        first: 0,
        last: 63,
        high: 0,
        low: 0,
    };
}

impl Frame {
    pub fn read(segment: &[u8], is_progressive: bool) -> Result<Self, Fault> {
        let [_, h0, h1, w0, w1, count, rest @ ..] = segment else {
            return Err(wrong());
        };
        let (width, height) = (
            u32::from(u16::from_be_bytes([*w0, *w1])),
            u32::from(u16::from_be_bytes([*h0, *h1])),
        );
        let (listed, _) = rest.as_chunks::<3>();
        if listed.len() != usize::from(*count)
            || !(1..=4).contains(&listed.len())
            || width == 0
            || height == 0
        {
            return Err(wrong());
        }
        let sampling = listed
            .iter()
            .map(|[_, factors, _]| (u32::from(factors >> 4), u32::from(factors & 15)))
            .collect::<Vec<_>>();
        let is_factor = |factor: u32| (1..=4).contains(&factor);
        if sampling
            .iter()
            .any(|(h, v)| !is_factor(*h) || !is_factor(*v))
        {
            return Err(wrong());
        }
        let most = sampling
            .iter()
            .fold((1, 1), |most, (h, v)| (most.0.max(*h), most.1.max(*v)));
        let units = (width.div_ceil(8 * most.0), height.div_ceil(8 * most.1));
        let components = listed.iter().zip(&sampling).map(|([id, ..], (h, v))| {
            let side = |texels: u32, factor: u32, most: u32| (texels * factor).div_ceil(8 * most);
            let all = u64::from(units.0 * h) * u64::from(units.1 * v);
            Component {
                id: *id,
                sampling: (*h, *v),
                blocks: (side(width, *h, most.0), side(height, *v, most.1)),
                stride: units.0 * h,
                low_bits: [None; 64],
                // Below 2^28: the sides have 16 bits, factors are at most 4.
                nonzero: vec![0; if is_progressive { all as usize } else { 0 }],
            }
        });
        Ok(Self {
            height,
            is_progressive,
            components: components.collect(),
            units,
            most,
        })
    }

    /// Rejects a picture of which something has not come.
    pub fn check_complete(&self) -> Result<(), Fault> {
        let is_whole = |bits: &Option<u8>| *bits == Some(0);
        let is_complete = |component: &Component| component.low_bits.iter().all(is_whole);
        match self.components.iter().all(is_complete) {
            true => Ok(()),
            false => Err(Fault::damaged("it ends before its last scans")),
        }
    }
}

impl Component {
    /// Notes that a scan brings a band of it.
    pub fn take(&mut self, band: Band) -> Result<(), Fault> {
        let before = (band.high > 0).then_some(band.high);
        let bits = &mut self.low_bits[usize::from(band.first)..=usize::from(band.last)];
        if bits.iter().any(|bits| *bits != before) {
            return Err(Fault::damaged(
                "a scan comes twice, or before those it refines",
            ));
        }
        bits.fill(Some(band.low));
        Ok(())
    }
}

fn wrong() -> Fault {
    Fault::damaged("a wrong frame header")
}
