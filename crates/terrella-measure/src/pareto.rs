//! The Pareto front of error and cost.

/// For each (cost, error), whether no other has both at most as large and one of them smaller. Smaller is better.
///
/// Equal points are on the front together. Non-finite ones never are.
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<bool> {
    let is_finite = |(cost, error): (f64, f64)| cost.is_finite() && error.is_finite();
    let beats = |a: (f64, f64), b: (f64, f64)| a.0 <= b.0 && a.1 <= b.1 && a != b;
    points
        .iter()
        .map(|point| {
            let mut others = points.iter().filter(|other| is_finite(**other));
            is_finite(*point) && !others.any(|other| beats(*other, *point))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = [
            (1.0, 9.0),
            (2.0, 4.0),
            (2.0, 5.0),
            (3.0, 4.0),
            (4.0, 1.0),
            (4.0, 1.0),
            (0.5, f64::NAN),
            (f64::INFINITY, 0.0),
        ];
        let expected = [true, true, false, false, true, true, false, false];
        assert_eq!(pareto_front(&points), expected);
        assert!(pareto_front(&[]).is_empty());
    }
}
