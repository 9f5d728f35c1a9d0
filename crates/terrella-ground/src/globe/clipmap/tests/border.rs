//! Neighbours and distances: the rules compared with the sphere itself.

use super::*;
use std::collections::VecDeque;

/// All points of the globe's lattice, each once, and their neighbours by triangles.
struct Globe {
    n: i64,
    icosahedron: Icosahedron,
    number: HashMap<Point, usize>,
    directions: Vec<DVec3>,
    /// By point: the points that share a triangle's edge with it, and those that share a cell.
    edges: Vec<HashSet<usize>>,
    cells: Vec<HashSet<usize>>,
}

impl Globe {
    fn new(n: i64) -> Self {
        let mut globe = Self {
            n,
            icosahedron: Icosahedron::default(),
            number: HashMap::default(),
            directions: Vec::new(),
            edges: Vec::new(),
            cells: Vec::new(),
        };
        for cell in cells(n) {
            let LatticeIndex { diamond, i, j } = cell;
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| {
                let index = LatticeIndex {
                    diamond,
                    i: i + x,
                    j: j + y,
                };
                globe.number_of(index)
            });
            for (x, a) in corners.into_iter().enumerate() {
                for (y, b) in corners.into_iter().enumerate() {
                    if x != y {
                        globe.cells[a].insert(b);
                        if x + y != 3 || x * y == 2 {
                            globe.edges[a].insert(b);
                        }
                    }
                }
            }
        }
        globe
    }

    fn number_of(&mut self, index: LatticeIndex) -> usize {
        let direction = self.icosahedron.direction(index, self.n);
        let next = self.directions.len();
        let number = *self.number.entry(bits(direction)).or_insert(next);
        if number == next {
            self.directions.push(direction);
            self.edges.push(HashSet::default());
            self.cells.push(HashSet::default());
        }
        number
    }

    fn at(&self, index: LatticeIndex) -> usize {
        self.number[&bits(self.icosahedron.direction(index, self.n))]
    }

    /// Steps from a point to all others.
    fn steps(&self, from: usize, links: &[HashSet<usize>]) -> Vec<i64> {
        let mut steps = vec![-1; links.len()];
        steps[from] = 0;
        let mut queue = VecDeque::from([from]);
        while let Some(at) = queue.pop_front() {
            for &next in &links[at] {
                if steps[next] < 0 {
                    steps[next] = steps[at] + 1;
                    queue.push_back(next);
                }
            }
        }
        steps
    }
}

fn cells(n: i64) -> impl Iterator<Item = LatticeIndex> {
    (0..DIAMONDS).flat_map(move |diamond| {
        (0..n * n).map(move |cell| LatticeIndex {
            diamond,
            i: cell / n,
            j: cell % n,
        })
    })
}

fn points(n: i64) -> impl Iterator<Item = LatticeIndex> {
    (0..DIAMONDS).flat_map(move |diamond| {
        (0..(n + 1) * (n + 1)).map(move |point| LatticeIndex {
            diamond,
            i: point / (n + 1),
            j: point % (n + 1),
        })
    })
}

#[test]
fn points_of_borders_are_the_same_in_all_their_diamonds() {
    for n in [1, 2, 8, 64] {
        let globe = Globe::new(n);
        assert_eq!(globe.directions.len() as i64, 10 * n * n + 2);
    }
}

#[test]
fn neighbours_by_rule_are_the_nearest_on_the_sphere() {
    let globe = Globe::new(8);
    for (at, direction) in globe.directions.iter().enumerate() {
        let linked = &globe.edges[at];
        let mut others: Vec<usize> = (0..globe.directions.len()).filter(|o| *o != at).collect();
        others.sort_by(|a, b| {
            let distance = |o: &usize| globe.directions[*o].distance(*direction);
            distance(a).total_cmp(&distance(b))
        });
        let nearest: HashSet<usize> = others[..linked.len()].iter().copied().collect();
        assert_eq!(&nearest, linked, "about {direction}");
    }
    let of_five = globe
        .edges
        .iter()
        .filter(|linked| linked.len() == 5)
        .count();
    assert_eq!(of_five, 12);
}

#[test]
fn every_border_of_every_home_leads_to_the_true_neighbours() {
    let n = 8;
    let globe = Globe::new(n);
    let mut crossings = 0;
    for cell in cells(n) {
        for far in [false, true] {
            let triangle = Triangle { cell, far };
            let [a, b, c] = triangle.corners().map(|corner| globe.at(corner));
            for ((x, y), beyond) in [(a, b), (b, c), (c, a)]
                .into_iter()
                .zip(triangle.neighbours(n))
            {
                let theirs = beyond.corners().map(|corner| globe.at(corner));
                // They share this edge, in the opposite direction, and nothing more.
                let k = (0..3).find(|k| theirs[*k] == y && theirs[(k + 1) % 3] == x);
                let k = k.unwrap_or_else(|| panic!("{triangle:?} has not {beyond:?} beside it"));
                let third = theirs[(k + 2) % 3];
                assert!(![a, b, c].contains(&third));
                // By distance on the sphere, the third corners are the two points nearest to both ends of the edge.
                let middle = (globe.directions[x] + globe.directions[y]).normalize();
                let mut others: Vec<usize> = (0..globe.directions.len())
                    .filter(|o| *o != x && *o != y)
                    .collect();
                others.sort_by(|p, q| {
                    let distance = |o: &usize| globe.directions[*o].distance(middle);
                    distance(p).total_cmp(&distance(q))
                });
                assert!(others[..2].contains(&third), "{triangle:?} to {beyond:?}");
                crossings += i64::from(beyond.cell.diamond != cell.diamond);
            }
        }
    }
    assert_eq!(crossings, 10 * 4 * n);
}

#[test]
fn the_virtual_diamond_holds_the_true_surroundings_of_all_homes() {
    let n = 8;
    let globe = Globe::new(n);
    let points_of = |diamond: u8| -> HashSet<usize> {
        points(n)
            .filter(|p| p.diamond == diamond)
            .map(|p| globe.at(p))
            .collect()
    };
    let mut places = 0;
    for home in 0..DIAMONDS {
        let cells = virtual_diamond(home);
        assert_eq!(cells[1][1], DiamondPlace::Home);
        let here = points_of(home);
        let across = |row: usize, column: usize| match cells[row][column] {
            DiamondPlace::Across(diamond) => diamond,
            other => panic!("{other:?} across an edge of {home}"),
        };
        let index = |i, j| {
            globe.at(LatticeIndex {
                diamond: home,
                i,
                j,
            })
        };
        for (row, column, edge) in [
            (0, 1, (0..=n).map(|t| index(0, t)).collect::<HashSet<_>>()),
            (1, 0, (0..=n).map(|t| index(t, 0)).collect()),
            (2, 1, (0..=n).map(|t| index(n, t)).collect()),
            (1, 2, (0..=n).map(|t| index(t, n)).collect()),
        ] {
            let there = points_of(across(row, column));
            assert_eq!(
                here.intersection(&there).copied().collect::<HashSet<_>>(),
                edge
            );
            places += 1;
        }
        for (row, column, corner) in [
            (0, 0, index(0, 0)),
            (0, 2, index(0, n)),
            (2, 0, index(n, 0)),
            (2, 2, index(n, n)),
        ] {
            // The diamonds at the corner are the home, the two across its edges, and those of the place.
            let mut said = HashSet::from_iter([home, across(row, 1), across(1, column)]);
            match cells[row][column] {
                DiamondPlace::Closed => {}
                DiamondPlace::Two(a, b) => {
                    said.extend([a, b]);
                    assert!(said.len() == 5 && globe.directions[corner].z.abs() == 1.0);
                }
                other => panic!("{other:?} beyond a corner of {home}"),
            }
            let true_ones: HashSet<u8> = (0..DIAMONDS)
                .filter(|d| points_of(*d).contains(&corner))
                .collect();
            assert_eq!(said, true_ones, "corner {row} {column} of {home}");
            places += 1;
        }
    }
    assert_eq!(places, 10 * 8);
}

#[test]
fn corners_are_walked_to_the_left_along_shared_edges() {
    let n = 8;
    let globe = Globe::new(n);
    for diamond in 0..DIAMONDS {
        for corner in 0..4 {
            let corner = DiamondCorner { diamond, corner };
            let left = corner.left();
            for t in 0..=n {
                let (mine, theirs) = (corner.index(0, t, n), left.index(t, 0, n));
                assert_eq!(globe.at(mine), globe.at(theirs), "{corner:?} {t}");
                assert_eq!(corner.steps(mine.i, mine.j, n), (0, t));
            }
            let round = (0..corner.valence()).fold(corner, |c, _| c.left());
            assert_eq!(round, corner);
            // Left means from the first edge to the second, seen from above.
            let at = |p, q| globe.icosahedron.direction(corner.index(p, q, n), n);
            assert!(at(0, 0).dot(at(1, 0).cross(at(0, 1))) > 0.0);
        }
    }
}

#[test]
fn distances_are_those_of_a_walk_over_the_globe() {
    for n in [8, 12] {
        let globe = Globe::new(n);
        let all: Vec<(LatticeIndex, usize)> = points(n).map(|p| (p, globe.at(p))).collect();
        for (trim, links) in [(Trim::Diamond, &globe.cells), (Trim::Hexagon, &globe.edges)] {
            for (middle, number) in &all {
                let steps = globe.steps(*number, links);
                let extent = LevelExtent::new(*middle, n, n / 2, trim);
                let mut within = HashSet::default();
                for (index, there) in &all {
                    let counted = extent.distance(*index).unwrap_or(i64::MAX);
                    if counted <= n / 2 {
                        assert_eq!(
                            counted, steps[*there],
                            "{trim:?} {n}: {middle:?} to {index:?}"
                        );
                        within.insert(*there);
                    } else {
                        let alone = counted == i64::MAX;
                        assert!(
                            alone || steps[*there] > n / 2,
                            "{trim:?}: {middle:?} to {index:?}"
                        );
                    }
                }
                // Everything within the extent is found, under some index, in a box that contains it.
                assert_eq!(within.len(), steps.iter().filter(|s| **s <= n / 2).count());
                for cell in cells(n) {
                    let triangle = Triangle {
                        cell,
                        far: cell.i % 2 == 0,
                    };
                    if extent.holds(triangle) {
                        let boxed = extent.boxes().find(|(d, _)| *d == cell.diamond);
                        let (_, span) = boxed.expect("a box");
                        for corner in triangle.corners() {
                            assert!(span.least.0 <= corner.i && corner.i <= span.most.0);
                            assert!(span.least.1 <= corner.j && corner.j <= span.most.1);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn a_point_reaches_the_same_triangles_from_each_of_its_homes() {
    let n = 12;
    let globe = Globe::new(n);
    for trim in [Trim::Diamond, Trim::Hexagon] {
        let mut held: HashMap<usize, HashSet<Triangle>> = HashMap::default();
        let mut again = 0;
        for middle in points(n) {
            let extent = LevelExtent::new(middle, n, n / 2, trim);
            let all = cells(n).flat_map(|cell| [false, true].map(|far| Triangle { cell, far }));
            let mine: HashSet<Triangle> = all.filter(|triangle| extent.holds(*triangle)).collect();
            if let Some(other) = held.insert(globe.at(middle), mine.clone()) {
                assert_eq!(other, mine, "{trim:?} {middle:?}");
                again += 1;
            }
        }
        assert_eq!(again, 10 * (n + 1) * (n + 1) - 10 * n * n - 2);
    }
}

#[test]
fn directions_are_found_again_and_faces_lie_where_the_paper_says() {
    let icosahedron = Icosahedron::default();
    let n = 1 << 20;
    for (k, index) in points(7).enumerate() {
        let fine = LatticeIndex {
            i: index.i * (n / 7),
            j: index.j * (n / 7),
            ..index
        };
        let direction = icosahedron.direction(fine, n);
        let (diamond, x, y) = icosahedron.locate(direction);
        let found = LatticeIndex {
            diamond,
            i: (x * n as f64).round() as i64,
            j: (y * n as f64).round() as i64,
        };
        assert!(
            icosahedron.direction(found, n).distance(direction) < 1e-12,
            "{k}: {fine:?} {found:?}"
        );
    }
    // The paper's appendix: middles of faces 0, 5, 10 and 15.
    for (diamond, i, lat_deg, lon_deg) in [
        (0, 1, 52.623, 36.0),
        (0, 2, 10.812, 36.0),
        (5, 1, -10.812, 72.0),
        (5, 2, -52.623, 72.0),
    ] {
        let normal = icosahedron.direction(LatticeIndex { diamond, i, j: i }, 3);
        assert!((normal.z.asin().to_degrees() - lat_deg).abs() < 1e-3);
        assert!((normal.y.atan2(normal.x).to_degrees() - lon_deg).abs() < 1e-3);
    }
}

#[test]
fn what_is_held_lies_in_boxes_and_ends_where_the_reach_ends() {
    let n = 8;
    for trim in [Trim::Diamond, Trim::Hexagon] {
        for radius in 1..=n / 2 {
            for middle in points(n) {
                let extent = LevelExtent::new(middle, n, radius, trim);
                let mut held = 0;
                for triangle in
                    cells(n).flat_map(|cell| [false, true].map(|far| Triangle { cell, far }))
                {
                    if !extent.holds(triangle) {
                        continue;
                    }
                    held += 1;
                    let span = extent.box_in(triangle.cell.diamond).expect("a box");
                    for corner in triangle.corners() {
                        assert!(span.least.0 <= corner.i && corner.i <= span.most.0);
                        assert!(span.least.1 <= corner.j && corner.j <= span.most.1);
                    }
                    // Only vertices that are drawn as the coarser level's may be on the border.
                    let ends = triangle.corners();
                    for (k, beyond) in triangle.neighbours(n).into_iter().enumerate() {
                        if !extent.holds(beyond) {
                            let at = |k: usize| extent.distance(ends[k % 3]);
                            assert_eq!((at(k), at(k + 1)), (Some(radius), Some(radius)));
                        }
                    }
                }
                assert!(held >= 2 * radius * radius, "{middle:?}: {held}");
            }
        }
    }
}
