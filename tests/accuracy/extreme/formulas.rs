//! Each formula over the whole range it is needed in: the stable form keeps its bound, the printed one does not.

use terrella_measure::numeric::{StabilityRow, formulas, measure, stability_table};

/// Expected errors of the forms that are only compared with, relative to the bound; 1 if they meet it as well and the stable form is a matter of
/// taste.
const COMPARED: &[(&str, &[f64])] = &[
    ("billboard, distance L2", &[1e8]),
    ("billboard, side S", &[5e7]),
    ("ray and ellipsoid, by height", &[1e4, 1e4]),
    // Near the ground an f64 has digits enough for every form.
    ("ray and ellipsoid, grazing", &[1.0, 1.0]),
    ("dip of the horizon, from the height", &[5e7]),
    ("dip of the horizon, from the eye's position", &[1.0]),
    ("geodetic coordinates", &[1e6, 1e6, 1e6]),
    ("texture coordinates of a pixel", &[20.0, 20.0]),
    ("texture coordinates of a pixel, far away", &[20.0, 5.0]),
    ("texture coordinates at the poles", &[200.0, 200.0]),
    ("texture coordinates at ±180°", &[2.0, 2.0]),
    ("normal at the poles", &[]),
    ("distance from depth", &[1e12]),
    ("mean sidereal time", &[200.0]),
];

#[test]
fn stable_forms_keep_their_bound_and_printed_ones_do_not() {
    let rows = stability_table();
    for row in &rows {
        println!("{}", row.text());
    }
    let mut seen = 0;
    for (name, claims) in COMPARED {
        let rows: Vec<&StabilityRow> = rows.iter().filter(|row| row.formula == *name).collect();
        let (stable, compared): (Vec<&StabilityRow>, Vec<_>) =
            rows.iter().copied().partition(|row| row.is_stable);
        assert_eq!(stable.len(), 1, "{name}: one form must keep the bound");
        assert!(
            stable[0].worst <= stable[0].bound,
            "the stable form breaks its bound: {}",
            stable[0].text()
        );
        assert_eq!(
            compared.len(),
            claims.len(),
            "{name}: forms without a claim"
        );
        for (row, times) in compared.iter().zip(*claims) {
            if *times == 1.0 {
                assert!(
                    row.worst <= row.bound,
                    "was thought to hold: {}",
                    row.text()
                );
            } else {
                let broken = row.worst >= times * row.bound;
                assert!(broken, "does not break {times} bounds: {}", row.text());
            }
        }
        seen += rows.len();
    }
    assert_eq!(seen, rows.len(), "a formula without a claim");
}

#[test]
fn every_formula_can_be_measured() {
    for formula in formulas() {
        let found = measure(formula.as_ref(), 1);
        let forms = formula.variants().len();
        assert_eq!(found.len(), forms * formula.sweep().values.len());
        for m in &found {
            let cost = m.cost.median;
            assert!(
                cost > 0.0 && cost < 1e6,
                "{}: {cost} {}",
                m.method,
                m.cost_unit
            );
        }
    }
}
