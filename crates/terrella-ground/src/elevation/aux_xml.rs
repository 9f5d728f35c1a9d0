//! Band metadata in GDAL's text beside a file, `NAME.aux.xml` (GDAL's Persistent Auxiliary Metadata).

/// Largest text that is read, bytes: histograms and attribute tables can be long.
pub const AUX_BYTES: u64 = 4 << 20;

/// The content of the first element with this name.
pub fn element<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let mut rest = text;
    loop {
        let (_, after) = rest.split_once('<')?;
        rest = after;
        let Some(tail) = after.strip_prefix(name) else {
            continue;
        };
        // Skip longer names.
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

/// The bands of the text, each up to the end of its element.
fn bands(text: &str) -> impl Iterator<Item = &str> {
    text.split("<PAMRasterBand")
        .skip(1)
        .map(|band| band.split("</PAMRasterBand>").next().unwrap_or_default())
}

/// The band with this number, from 1. Among bands without numbers, the one at that position.
fn band(text: &str, number: u16) -> &str {
    let called = format!("band=\"{number}\"");
    let head = |band: &str| band.split('>').next().unwrap_or_default().to_owned();
    bands(text)
        .enumerate()
        .find(|(n, band)| match head(band) {
            head if head.contains("band=") => head.contains(&called),
            _ => n + 1 == usize::from(number),
        })
        .map_or("", |(_, band)| band)
}

/// The content of a band's element with this name, with XML entities decoded. Bands count from 1.
pub fn band_text(text: &str, of_band: u16, name: &str) -> Option<String> {
    element(band(text, of_band), name).map(plain)
}

/// The value of a band's numeric element with this name. Bands count from 1.
///
/// # Errors
/// The element's content, if it is not a number.
pub fn band_number(text: &str, of_band: u16, name: &str) -> Result<Option<f64>, String> {
    number(band(text, of_band), name)
}

/// The no-data values of all bands, if every band has one.
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

/// Decodes XML entities.
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
        assert_eq!(band_number(TEXT, 1, "NoDataValue"), Ok(Some(-5000.0)));
        assert_eq!(band_text(TEXT, 1, "UnitType").as_deref(), Some("ft"));
        assert_eq!(band_text(TEXT, 2, "UnitType"), None);
        assert_eq!(band_text(TEXT, 1, "Unit"), None);
        assert_eq!(band_number(TEXT, 1, "Scale"), Ok(None));
        let second = band_number(TEXT, 2, "NoDataValue");
        assert!(second.is_ok_and(|number| number.is_some_and(f64::is_nan)));
        assert!(band_number(&TEXT.replace("<Scale/>", "<Scale>x</Scale>"), 1, "Scale").is_err());
        // Only bands with metadata are listed.
        let second = "<PAMRasterBand band=\"2\"><UnitType>m</UnitType></PAMRasterBand>";
        assert_eq!(band_text(second, 1, "UnitType"), None);
        assert_eq!(band_text(second, 2, "UnitType").as_deref(), Some("m"));
        let all = no_data(TEXT).expect("numbers").expect("two");
        assert!(all[0] == -5000.0 && all[1].is_nan() && all.len() == 2);
        // A value of only one band is no no-data value of a colour.
        let one = TEXT.replace("<NoDataValue>nan</NoDataValue>", "");
        assert_eq!(no_data(&one), Ok(None));
        for broken in [
            "",
            "<PAMRasterBand",
            "<PAMRasterBand><NoDataValue>1",
            "<NoDataValue>1</NoDataValue>",
        ] {
            assert_eq!(band_number(broken, 1, "NoDataValue"), Ok(None), "{broken}");
        }
    }
}
