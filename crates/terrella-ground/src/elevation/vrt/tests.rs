//! Output of `gdalbuildvrt`, and all features rejected by name.

use super::*;

/// Written by gdalbuildvrt 3.9.
const TWO: &str = r#"<VRTDataset rasterXSize="20" rasterYSize="10">
  <SRS dataAxisToSRSAxisMapping="2,1">GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]]</SRS>
  <GeoTransform>  6.0000000000000000e+00,  1.0000000000000001e-01,  0.0,  4.6e+01,  0.0, -1.0e-01</GeoTransform>
  <OverviewList resampling="average">2 4</OverviewList>
  <VRTRasterBand dataType="Int16" band="1">
    <NoDataValue>-32768</NoDataValue>
    <ColorInterp>Gray</ColorInterp>
    <ComplexSource>
      <SourceFilename relativeToVRT="1">a &amp; b/west.tif</SourceFilename>
      <SourceBand>1</SourceBand>
      <SourceProperties RasterXSize="10" RasterYSize="10" DataType="Int16" BlockXSize="10" BlockYSize="10" />
      <SrcRect xOff="0" yOff="0" xSize="10" ySize="10" />
      <DstRect xOff="0" yOff="0" xSize="10" ySize="10" />
      <NODATA>-32768</NODATA>
    </ComplexSource>
    <SimpleSource>
      <SourceFilename relativeToVRT="0">/data/east.tif</SourceFilename>
      <SrcRect xOff="2" yOff="0" xSize="8" ySize="10" />
      <DstRect xOff="10" yOff="0" xSize="10" ySize="10" />
    </SimpleSource>
  </VRTRasterBand>
</VRTDataset>
"#;

fn read(text: &str) -> Result<Vrt, String> {
    Vrt::read(text, Path::new("maps")).map_err(|error| error.to_string())
}

#[test]
fn bands_and_sources_are_read() {
    let vrt = read(TWO).expect("good");
    assert_eq!(vrt.size, (20, 10));
    assert!(
        vrt.system
            .expect("a system")
            .starts_with("GEOGCS[\"WGS 84\"")
    );
    let grid = vrt.grid.expect("a place");
    assert_eq!(
        (grid.west, grid.north, grid.column, grid.row),
        (6.0, 46.0, 0.1, 0.1)
    );
    let [band] = vrt.bands.as_slice() else {
        panic!("one band");
    };
    assert_eq!(band.no_data, Some(-32_768.0));
    let [west, east] = band.sources.as_slice() else {
        panic!("two sources");
    };
    assert_eq!(west.path, Path::new("maps/a & b/west.tif"));
    assert_eq!(
        (west.band, west.size, west.line),
        (Some(1), Some((10, 10)), 8)
    );
    assert_eq!(
        (west.no_data, west.is_whole(), west.is_plain()),
        (Some(-32_768.0), true, true)
    );
    assert_eq!(east.path, Path::new("/data/east.tif"));
    assert_eq!(
        (east.is_whole(), east.to),
        (false, Some([10.0, 0.0, 10.0, 10.0]))
    );
}

#[test]
fn what_is_not_read_is_named_with_its_line() {
    for (from, to, words) in [
        (
            "<VRTDataset ",
            "<VRTDataset subClass=\"VRTWarpedDataset\" ",
            "line 1: is a VRTWarpedDataset",
        ),
        (
            "band=\"1\">",
            "band=\"1\" subClass=\"VRTDerivedRasterBand\">",
            "line 5: has a VRTDerivedRasterBand",
        ),
        (
            "ComplexSource>",
            "KernelFilteredSource>",
            "line 8: has a <KernelFilteredSource>",
        ),
        (
            "<NODATA>-32768</NODATA>",
            "<LUT>0:0,255:1</LUT>",
            "line 14: has a source with <LUT>",
        ),
        (
            "/data/east.tif",
            "/vsizip/east.zip",
            "line 17: has a source in an archive",
        ),
        (
            "/data/east.tif",
            "https://a.b/c.tif",
            "line 17: has a source in an archive or on a server",
        ),
        (
            "/data/east.tif",
            "NETCDF:a.nc:z",
            "has a source that is not a file",
        ),
        (
            "/data/east.tif",
            "self.VRT",
            "has another virtual raster as a source: \"self.VRT\"",
        ),
        (
            "6.0000000000000000e+00,  1.0",
            "6, -1.0",
            "is rotated, or runs from east to west",
        ),
        ("1.0000000000000001e-01,  0.0", "0.1, 0.2", "is rotated"),
        ("GeoTransform>", "GCPList>", "line 3: has a <GCPList>"),
        (
            "<NODATA>-32768",
            "<NODATA>none",
            "NODATA is \"none\", not a number",
        ),
        ("xSize=\"8\"", "xSize=\"-8\"", "a rectangle of no size"),
        (
            "rasterXSize=\"20\"",
            "rasterXSize=\"0\"",
            "rasterXSize is \"0\"",
        ),
        ("/data/east.tif", "", "a source without a file"),
        ("</VRTDataset>", "", "the file ends too early"),
        ("VRTDataset", "html", "line 1: no <VRTDataset>"),
        ("&amp;", "&boom;", "unknown entity &boom;"),
        (
            "<VRTDataset r",
            "<!DOCTYPE a><VRTDataset r",
            "has a document type",
        ),
    ] {
        let text = TWO.replace(from, to);
        assert_ne!(text, TWO, "{from}");
        let said = read(&text).expect_err(to);
        assert!(said.contains(words), "{to}: {said}");
    }
    let many = TWO.replacen("    <SimpleSource>", &"<a>".repeat(40), 1);
    assert!(
        read(&many)
            .expect_err("deep")
            .contains("more than 32 elements")
    );
}
