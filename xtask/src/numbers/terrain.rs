//! Tables of `terrella terrain`.

use super::markdown::table;
use super::record::Recorded;
use anyhow::Context;

/// Node orders in memory, each compared with the plain order: the recorded columns, and the smallest time to visit all nodes relative to that of
/// the plain order on the same terrain.
pub fn orders(run: &Recorded) -> anyhow::Result<String> {
    let rows = run.rows()?;
    let mut heads = run.columns()?.to_vec();
    heads.push("over plain".to_owned());
    let mut lines = Vec::new();
    for row in &rows {
        let (ground, size) = (row.text("ground")?, row.text("size")?);
        let mut plain = None;
        for other in &rows {
            if (
                other.text("ground")?,
                other.text("size")?,
                other.text("order")?,
            ) == (ground, size, "plain")
            {
                plain = Some(other.number("all, least")?);
            }
        }
        let plain = plain.with_context(|| format!("it has no plain order of {ground}, {size}"))?;
        let mut fields = row.fields.to_vec();
        fields.push(format!("{:.2}", row.number("all, least")? / plain));
        lines.push(fields);
    }
    Ok(table(&heads, lines))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::record::{KEYS, written};

    #[test]
    fn orders_stand_beside_plain_order_of_their_ground() {
        let head = KEYS.map(|key| (key, "x".to_owned()));
        let body = "ground,size,order,\"all, least\"\na,1,plain,4\na,1,Morton,3\nb,1,plain,2\nb,1,Morton,3\n";
        let run = Recorded::read("a.csv", &written("a.csv", &head, body).unwrap()).unwrap();
        let text = orders(&run).unwrap();
        assert!(text.contains("| a | 1 | Morton | 3 | 0.75 |"), "{text}");
        assert!(text.contains("| b | 1 | Morton | 3 | 1.50 |"), "{text}");
    }
}
