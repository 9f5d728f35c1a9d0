//! What GDAL's text beside a file, `NAME.aux.xml`, says of a band (GDAL's Persistent Auxiliary Metadata).

/// Largest text that is read, bytes: histograms and tables of attributes make some long.
pub const AUX_BYTES: u64 = 4 << 20;

/// The text of the first element of this name.
pub fn element<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let mut rest = text;
    loop {
        let (_, after) = rest.split_once('<')?;
        rest = after;
        let Some(tail) = after.strip_prefix(name) else {
            continue;
        };
        // Not a longer name.
        if !tail.starts_with([' ', '>', '\t', '\n', '\r']) {
            continue;
        }
        let (head, inside) = tail.split_once('>')?;
        if head.ends_with('/') {
            return None;
        }
        let end = inside.find(&format!("</{name}>"))?;
        return Some(&inside[..end]);
    }
}

/// Bands of the text, each as far as its element goes.
fn bands(text: &str) -> impl Iterator<Item = &str> {
    text.split("<PAMRasterBand")
        .skip(1)
        .map(|band| band.split("</PAMRasterBand>").next().unwrap_or_default())
}

/// The text of the first band's element of this name, without marks of XML.
pub fn band_text(text: &str, name: &str) -> Option<String> {
    bands(text)
        .next()
        .and_then(|band| element(band, name))
        .map(plain)
}

/// The number of the first band's element of this name.
///
/// # Errors
/// What stands there, if it is no number.
pub fn band_number(text: &str, name: &str) -> Result<Option<f64>, String> {
    number(bands(text).next().unwrap_or_default(), name)
}

/// The numbers of no data of all bands, where each has one.
///
/// # Errors
/// As [`band_number`].
pub fn no_data(text: &str) -> Result<Option<Vec<f64>>, String> {
    bands(text)
        .map(|band| number(band, "NoDataValue"))
        .collect::<Result<Option<Vec<_>>, _>>()
        .map(|all| all.filter(|all| !all.is_empty()))
}

fn number(band: &str, name: &str) -> Result<Option<f64>, String> {
    let Some(word) = element(band, name).map(plain) else {
        return Ok(None);
    };
    match word.parse() {
        Ok(number) => Ok(Some(number)),
        Err(_) => {
            let shown: String = word.chars().take(40).collect();
            Err(format!("has the {name} {shown:?}"))
        }
    }
}

/// Without marks of XML.
pub fn plain(text: &str) -> String {
    let marks = [
        ("&quot;", "\""),
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&apos;", "'"),
        ("&amp;", "&"),
    ];
    let plain = marks
        .iter()
        .fold(text.to_string(), |text, (mark, of)| text.replace(mark, of));
    plain.trim().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "<PAMDataset>\n  <SRS dataAxisToSRSAxisMapping=\"2,1\">GEOGCS[&quot;WGS 84&quot;]</SRS>\n  \
        <PAMRasterBand band=\"1\">\n    <NoDataValue le_hex_equiv=\"00\">-5.00000000000000E+03</NoDataValue>\n    \
        <UnitType>ft</UnitType>\n    <Scale/>\n  </PAMRasterBand>\n  \
        <PAMRasterBand band=\"2\"><NoDataValue>nan</NoDataValue></PAMRasterBand>\n</PAMDataset>\n";

    #[test]
    fn elements_of_bands_are_found() {
        assert_eq!(
            element(TEXT, "SRS").map(plain).as_deref(),
            Some("GEOGCS[\"WGS 84\"]")
        );
        assert_eq!(band_number(TEXT, "NoDataValue"), Ok(Some(-5000.0)));
        assert_eq!(band_text(TEXT, "UnitType").as_deref(), Some("ft"));
        assert_eq!(band_text(TEXT, "Unit"), None);
        assert_eq!(band_number(TEXT, "Scale"), Ok(None));
        assert!(band_number(&TEXT.replace("<Scale/>", "<Scale>x</Scale>"), "Scale").is_err());
        let all = no_data(TEXT).expect("numbers").expect("two");
        assert!(all[0] == -5000.0 && all[1].is_nan() && all.len() == 2);
        // Of one band alone it is none of a colour.
        let one = TEXT.replace("<NoDataValue>nan</NoDataValue>", "");
        assert_eq!(no_data(&one), Ok(None));
        for broken in [
            "",
            "<PAMRasterBand",
            "<PAMRasterBand><NoDataValue>1",
            "<NoDataValue>1</NoDataValue>",
        ] {
            assert_eq!(band_number(broken, "NoDataValue"), Ok(None), "{broken}");
        }
    }
}
