//! Variables and their attributes, independent of the container.

use super::number::NumberType;
use super::stored::Values;
use crate::elevation::geoid::VerticalDatum;
use crate::elevation::read::missing::Missing;

/// Maximum dimensions, attributes or variables of one list.
pub(super) const MAX_ENTRIES: u64 = 1024;
/// Maximum length of a stored name or text, bytes.
pub(super) const TEXT_BYTES: u64 = 256;

/// An attribute's values: text or numbers, up to the limit.
pub(super) enum AttributeValue {
    Text(String),
    Numbers(NumberType, Vec<f64>),
}

pub(super) type Attributes = Vec<(String, AttributeValue)>;

pub(super) fn numbers<'a>(
    attributes: &'a Attributes,
    name: &str,
) -> Option<(NumberType, &'a [f64])> {
    attributes.iter().find_map(|(n, value)| match value {
        AttributeValue::Numbers(kind, numbers) if n == name => Some((*kind, numbers.as_slice())),
        _ => None,
    })
}

pub(super) fn number(attributes: &Attributes, name: &str) -> Option<f64> {
    numbers(attributes, name).and_then(|(_, numbers)| numbers.first().copied())
}

pub(super) fn text<'a>(attributes: &'a Attributes, name: &str) -> Option<&'a str> {
    attributes.iter().find_map(|(n, value)| match value {
        // C programs also write the terminating zero of their strings.
        AttributeValue::Text(text) if n == name => Some(text.trim_end_matches('\0')),
        _ => None,
    })
}

/// Contents of a file, with its readable variables.
pub(super) struct Contents {
    /// Names and lengths; a length of 0 marks the record dimension.
    pub dimensions: Vec<(String, u64)>,
    pub attributes: Attributes,
    pub variables: Vec<Variable>,
}

pub(super) struct Variable {
    pub name: String,
    /// Indices of its dimensions, the slowest first.
    pub dimensions: Vec<usize>,
    pub attributes: Attributes,
    pub kind: NumberType,
    pub values: Values,
}

impl Variable {
    /// Whether its integers are meant as unsigned, for which the classic format has no types (NetCDF Users Guide, `_Unsigned`).
    pub(super) fn is_unsigned(&self) -> bool {
        text(&self.attributes, "_Unsigned").is_some_and(|word| word.eq_ignore_ascii_case("true"))
    }

    /// Whether its values increase downwards (CF Conventions 1.11, 4.3 and the table of standard
    /// names).
    pub(super) fn is_depth(&self) -> bool {
        let positive = text(&self.attributes, "positive");
        let name = text(&self.attributes, "standard_name");
        positive.is_some_and(|word| word.eq_ignore_ascii_case("down"))
            || name.is_some_and(|name| name == "depth" || name.starts_with("sea_floor_depth_below"))
    }

    /// Vertical datum of its heights, `None` if its standard name does not state it.
    pub(super) fn above(&self) -> Option<VerticalDatum> {
        let name = text(&self.attributes, "standard_name");
        name.filter(|name| name.ends_with("_reference_ellipsoid"))
            .map(|_| VerticalDatum::Ellipsoid)
    }

    /// Converts a number of an attribute as the variable's own values are converted.
    fn as_stored(&self, kind: NumberType, number: f64) -> f64 {
        match self.is_unsigned() && kind == self.kind {
            true => kind.unsigned(number),
            false => number,
        }
    }

    /// Stored numbers that mean no data (NetCDF Users Guide, appendix A); `None` if there are too many.
    pub(super) fn missing(&self) -> Option<Missing> {
        let mut values = Vec::new();
        for name in ["_FillValue", "missing_value"] {
            if let Some((kind, numbers)) = numbers(&self.attributes, name) {
                values.extend(numbers.iter().map(|number| self.as_stored(kind, *number)));
            }
        }
        if number(&self.attributes, "_FillValue").is_none() {
            let fill = self.kind.default_fill();
            values.extend(fill.map(|fill| self.as_stored(self.kind, fill)));
        }
        values.dedup();
        let (lowest, highest) = self.valid();
        let missing = Missing::of_all(&values)?.outside(lowest, highest);
        let names = ["_FillValue", "missing_value"];
        let is_declared = names
            .iter()
            .any(|name| number(&self.attributes, name).is_some());
        Some(match is_declared {
            true => missing,
            false => missing.by_default(),
        })
    }

    /// Lowest and highest valid stored number.
    fn valid(&self) -> (f64, f64) {
        let first = |name| numbers(&self.attributes, name).map(|(kind, of)| (kind, of.first()));
        let (lowest, highest) = match numbers(&self.attributes, "valid_range") {
            Some((kind, [lowest, highest, ..])) => (Some((kind, lowest)), Some((kind, highest))),
            _ => {
                let bound = |name| first(name).and_then(|(kind, of)| Some((kind, of?)));
                (bound("valid_min"), bound("valid_max"))
            }
        };
        let scale = number(&self.attributes, "scale_factor").unwrap_or(1.0);
        let bound = |bound: Option<(NumberType, &f64)>, outwards: f64| match bound {
            Some((kind, number)) => {
                let stored = self.stored_bound(kind, *number);
                // A bound in one precision must not exclude the same number in another.
                stored + outwards * 1e-6 * (1.0 + stored.abs())
            }
            None => outwards * f64::INFINITY,
        };
        // After unpacking, a negative scale reverses the range.
        let is_turned = scale < 0.0
            && [lowest, highest]
                .iter()
                .flatten()
                .all(|(kind, _)| self.is_unpacked(*kind));
        match is_turned {
            true => (bound(highest, -1.0), bound(lowest, 1.0)),
            false => (bound(lowest, -1.0), bound(highest, 1.0)),
        }
    }

    fn stored_bound(&self, kind: NumberType, bound: f64) -> f64 {
        if !self.is_unpacked(kind) {
            return self.as_stored(kind, bound);
        }
        let scale = number(&self.attributes, "scale_factor").unwrap_or(1.0);
        let offset = number(&self.attributes, "add_offset").unwrap_or(0.0);
        (bound - offset) / scale
    }

    /// Whether a bound refers to unpacked numbers. It then has the type of scale and offset, which is wider than the variable's.
    fn is_unpacked(&self, kind: NumberType) -> bool {
        let of = |name| numbers(&self.attributes, name).map(|(kind, _)| kind);
        let packing = [of("scale_factor"), of("add_offset")];
        let widest = packing.into_iter().flatten().max_by_key(|kind| kind.rank());
        widest.is_some_and(|widest| kind == widest && widest.rank() > self.kind.rank())
    }
}
