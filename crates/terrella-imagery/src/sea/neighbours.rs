//! The texels around those of a map that covers the whole Earth.

/// Gives each row of a map, `width` texels to a row, and of each of its texels the greatest value of the texels around it.
pub(super) fn each_row_near(map: &[u8], width: usize, mut take: impl FnMut(&[u8], &[u8])) {
    /// Of each texel of a row the greater of its neighbours in it, and the greatest with itself.
    fn spread(row: &[u8], beside: &mut [u8], of_three: &mut [u8]) {
        let width = row.len();
        let triples = row.iter().zip(row.iter().skip(2));
        for (out, (west, east)) in beside[1..].iter_mut().zip(triples) {
            *out = *west.max(east);
        }
        beside[0] = row[width - 1].max(row[1 % width]);
        beside[width - 1] = row[width.saturating_sub(2)].max(row[0]);
        for (out, (beside, here)) in of_three.iter_mut().zip(beside.iter().zip(row)) {
            *out = *beside.max(here);
        }
    }
    let row_of = || vec![0_u8; width];
    let (mut north, mut here, mut south) = (row_of(), row_of(), row_of());
    let (mut beside, mut beside_south, mut greatest) = (row_of(), row_of(), row_of());
    let mut rows = map.chunks_exact(width);
    let Some(mut row) = rows.next() else {
        return;
    };
    spread(row, &mut beside, &mut here);
    loop {
        let next = rows.next();
        match next {
            Some(next) => spread(next, &mut beside_south, &mut south),
            None => south.fill(0),
        }
        let beyond = north.iter().zip(&south);
        for (out, (beside, (north, south))) in greatest.iter_mut().zip(beside.iter().zip(beyond)) {
            *out = *beside.max(north).max(south);
        }
        take(row, &greatest);
        let Some(next) = next else {
            return;
        };
        row = next;
        std::mem::swap(&mut beside, &mut beside_south);
        std::mem::swap(&mut north, &mut here);
        std::mem::swap(&mut here, &mut south);
    }
}

/// The texels around one: eight, fewer at a pole.
pub(super) struct Near {
    texels: [usize; 8],
    count: usize,
}

impl Near {
    pub(super) fn as_slice(&self) -> &[usize] {
        &self.texels[..self.count]
    }
}

pub(super) fn neighbours(n: usize, width: usize, height: usize) -> Near {
    // Maps have at most 2²⁹ texels, and short numbers are divided faster.
    let (x, y) = (
        (n as u32 % width as u32) as usize,
        (n as u32 / width as u32) as usize,
    );
    let west = if x == 0 { n + width - 1 } else { n - 1 };
    let east = if x + 1 == width { n + 1 - width } else { n + 1 };
    if y > 0 && y + 1 < height {
        let [north, south] = [
            [west, n, east].map(|n| n - width),
            [west, n, east].map(|n| n + width),
        ];
        return Near {
            texels: [
                north[0], north[1], north[2], west, east, south[0], south[1], south[2],
            ],
            count: 8,
        };
    }
    let (mut texels, mut count) = ([0; 8], 0);
    let mut add = |n: usize| {
        texels[count] = n;
        count += 1;
    };
    if y > 0 {
        [west, n, east].into_iter().for_each(|n| add(n - width));
    }
    [west, east].into_iter().for_each(&mut add);
    if y + 1 < height {
        [west, n, east].into_iter().for_each(|n| add(n + width));
    }
    Near { texels, count }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_near_is_that_of_the_neighbours() {
        for (width, height) in [(2, 1), (4, 2), (8, 4), (32, 16)] {
            let map: Vec<u8> = (0..width * height)
                .map(|n| ((n * 2_654_435_761) >> 7) as u8)
                .collect();
            let mut greatest = Vec::new();
            each_row_near(&map, width, |_, near| greatest.extend_from_slice(near));
            assert_eq!(greatest.len(), map.len());
            for (n, found) in greatest.iter().enumerate() {
                let near = neighbours(n, width, height);
                let near = near.as_slice().iter().map(|n| map[*n]);
                assert_eq!(near.max(), Some(*found), "{width} × {height}: {n}");
            }
        }
    }
}
