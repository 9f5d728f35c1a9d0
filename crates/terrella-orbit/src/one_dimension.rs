//! Where something changes, and where it is greatest, between two times in seconds.

/// Two times at most `exact_s` apart, between which something turns that has not at `low` and has at `high`.
///
/// # Errors
/// The first of `has_turned`.
pub(crate) fn bisect<E>(
    mut low: f64,
    mut high: f64,
    exact_s: f64,
    has_turned: impl Fn(f64) -> Result<bool, E>,
) -> Result<(f64, f64), E> {
    while high - low > exact_s {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        match has_turned(middle)? {
            true => high = middle,
            false => low = middle,
        }
    }
    Ok((low, high))
}

/// The time of the greatest value between two times, and the value, by golden section: to `exact_s`, or until a value `is_enough`.
///
/// # Errors
/// The first of `value`.
pub(crate) fn greatest<E>(
    mut low: f64,
    mut high: f64,
    exact_s: f64,
    value: impl Fn(f64) -> Result<f64, E>,
    is_enough: impl Fn(f64) -> bool,
) -> Result<(f64, f64), E> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;

    let (mut left, mut right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut at_left, mut at_right) = (value(left)?, value(right)?);
    while high - low > exact_s && low < left && right < high {
        if is_enough(at_left.max(at_right)) {
            break;
        }
        if at_left > at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - GOLDEN * (high - low);
            at_left = value(left)?;
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + GOLDEN * (high - low);
            at_right = value(right)?;
        }
    }
    Ok(match at_left > at_right {
        true => (left, at_left),
        false => (right, at_right),
    })
}
