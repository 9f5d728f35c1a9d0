"""Makes the TIFF files of this folder with GDAL, and `expected.txt`: what GDAL itself reads back at 50 places of each.

    pip install rasterio==1.4.4 numpy
    python tests/data/gdal/make.py
"""

import os
import pathlib
import warnings

import numpy as np
import rasterio
from rasterio.transform import from_origin

warnings.filterwarnings("ignore")
FOLDER = pathlib.Path(__file__).parent
WIDTH, HEIGHT = 72, 36
rng = np.random.default_rng(7)
row, column = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)
# Whole periods, so that no colour has an edge: decoders interpolate chrominance in different ways there.
wave = np.sin(column * np.pi / 18) * np.cos(row / 7.0)


def picture(bands):
    """Smooth colours of 8 bits."""
    return np.stack([(128 + 100 * np.roll(wave, 5 * n, 1)).astype("u1") for n in range(bands)])


def write(name, samples, colormap=None, mask=None, **options):
    samples = samples if samples.ndim == 3 else samples[None]
    bands, height, width = samples.shape
    profile = dict(driver="GTiff", width=width, height=height, count=bands, dtype=samples.dtype,
                   crs="EPSG:4326", transform=from_origin(-180, 90, 360 / width, 180 / height), **options)
    with rasterio.open(FOLDER / name, "w", **profile) as file:
        file.write(samples)
        if bands == 1 and samples.dtype != "u1":
            file.set_band_unit(1, "m")
        if colormap:
            file.write_colormap(1, colormap)
        if mask is not None:
            file.write_mask(mask)
    aux = FOLDER / (name + ".aux.xml")
    if aux.exists():
        aux.unlink()


os.environ["GDAL_TIFF_INTERNAL_MASK"] = "YES"
tiles = dict(tiled=True, blockxsize=32, blockysize=16)
heights = np.round(400 * wave + 3 * rng.standard_normal((HEIGHT, WIDTH)), 2)
f32, i16 = heights.astype("f4"), heights.astype("i2")
holes = f32.copy()
holes[5:20, 10:40] = np.nan

# Elevation, and what any number may be.
write("zstd_i16_predictor_2.tif", i16, compress="ZSTD", predictor=2, **tiles)
write("zstd_f32_predictor_3.tif", f32, compress="ZSTD", predictor=3, **tiles)
write("zstd_f64_big_endian.tif", heights, compress="ZSTD", ENDIANNESS="BIG", blockysize=10)
write("zstd_u32_predictor_2.tif", (heights + 9000).astype("u4"), compress="ZSTD", predictor=2, blockysize=10)
write("lzw_i16_predictor_2.tif", i16, compress="LZW", predictor=2, **tiles)
write("deflate_f32_predictor_3.tif", f32, compress="DEFLATE", predictor=3, **tiles)
write("lerc_f32.tif", f32, compress="LERC", MAX_Z_ERROR=0.01, **tiles)
write("lerc_f32_exact.tif", f32, compress="LERC", **tiles)
write("lerc_f32_holes.tif", holes, compress="LERC", MAX_Z_ERROR=0.1, nodata=np.nan, **tiles)
write("lerc_i16.tif", i16, compress="LERC", **tiles)
write("lerc_f64_zstd.tif", heights, compress="LERC_ZSTD", MAX_Z_ERROR=0.001, blockysize=10)
write("lerc_f32_deflate.tif", f32, compress="LERC_DEFLATE", MAX_Z_ERROR=0.5, **tiles)

# Imagery.
write("jpeg_rgb.tif", picture(3), compress="JPEG", photometric="RGB", JPEG_QUALITY=90, **tiles)
write("jpeg_ycbcr.tif", picture(3), compress="JPEG", photometric="YCBCR", JPEG_QUALITY=90, **tiles)
write("jpeg_grey.tif", picture(1), compress="JPEG", JPEG_QUALITY=90, blockysize=16)
write("jpeg_planar.tif", picture(3), compress="JPEG", INTERLEAVE="BAND", photometric="RGB", **tiles)
write("jpeg_mask.tif", picture(3), compress="JPEG", photometric="YCBCR",
      mask=np.where(row < 12, 0, 255).astype("u1"), **tiles)
write("webp_rgb.tif", picture(3), compress="WEBP", WEBP_LOSSLESS="YES", photometric="RGB", **tiles)
write("webp_rgba.tif", picture(4), compress="WEBP", WEBP_LOSSLESS="YES", photometric="RGB", ALPHA="YES", **tiles)
write("webp_lossy.tif", picture(3), compress="WEBP", WEBP_LEVEL=80, photometric="RGB", **tiles)
write("lerc_u8.tif", picture(3), compress="LERC", photometric="RGB", **tiles)
write("lerc_rough_u8.tif", rng.integers(0, 9, (1, HEIGHT, WIDTH)).astype("u1") ** 2, compress="LERC", **tiles)
write("zstd_planar.tif", picture(3), compress="ZSTD", predictor=2, INTERLEAVE="BAND", photometric="RGB", **tiles)
for bits in (1, 2, 4):
    few = (picture(1) >> (8 - bits)).astype("u1")
    write(f"palette_{bits}.tif", few, NBITS=bits, compress="ZSTD", photometric="PALETTE",
          colormap={n: (n * 17 % 256, 255 - n * 15, n * 40 % 256, 255) for n in range(1 << bits)}, **tiles)
    write(f"grey_{bits}.tif", few, NBITS=bits, compress="DEFLATE", **tiles)


def virtual(name, kind, sources, bands=1, no_data=None):
    """A virtual raster of 72 x 36 pixels: files with the rectangle that is taken and where it goes."""
    text = f'<VRTDataset rasterXSize="{WIDTH}" rasterYSize="{HEIGHT}">\n  <SRS>EPSG:4326</SRS>\n'
    text += "  <GeoTransform>-180, 5, 0, 90, 0, -5</GeoTransform>\n"
    for band in range(1, bands + 1):
        text += f'  <VRTRasterBand dataType="{kind}" band="{band}">\n'
        text += f"    <NoDataValue>{no_data}</NoDataValue>\n" if no_data is not None else ""
        for file, size, source, to in sources:
            element = "SimpleSource" if no_data is None else "ComplexSource"
            text += f'    <{element}>\n      <SourceFilename relativeToVRT="1">{file}</SourceFilename>\n'
            text += f"      <SourceBand>{band}</SourceBand>\n"
            text += f'      <SourceProperties RasterXSize="{size[0]}" RasterYSize="{size[1]}" />\n'
            for rect, numbers in (("SrcRect", source), ("DstRect", to)):
                text += "      <{} xOff=\"{}\" yOff=\"{}\" xSize=\"{}\" ySize=\"{}\" />\n".format(rect, *numbers)
            text += f"      <NODATA>{no_data}</NODATA>\n" if no_data is not None else ""
            text += f"    </{element}>\n"
        text += "  </VRTRasterBand>\n"
    (FOLDER / name).write_text(text + "</VRTDataset>\n")


def part(name, samples, west, north, **options):
    """A file of cells of 5 degrees."""
    bands, height, width = samples.shape
    with rasterio.open(FOLDER / name, "w", driver="GTiff", width=width, height=height, count=bands, dtype=samples.dtype,
                       crs="EPSG:4326", transform=from_origin(west, north, 5, 5), compress="DEFLATE", **options) as file:
        file.write(samples)


# The eastern part lies over the western and has a hole.
hole = i16.copy()
hole[10:14, 40:44] = -32768
part("part_west.tif", i16[None, :, :40] + 1000, -180, 90, nodata=-32768)
part("part_east.tif", hole[None, :, 36:], 0, 90, nodata=-32768)
whole = (0, 0, 40, 36), (0, 0, 36, 36)
virtual("heights.vrt", "Int16", [
    ("part_west.tif", (40, 36), whole[0], whole[0]), ("part_east.tif", (36, 36), whole[1], (36, 0, 36, 36))], no_data=-32768)
# Windows of one file, in another order than they lie in it.
virtual("map.vrt", "Byte", [
    ("webp_rgb.tif", (72, 36), (20, 0, 36, 36), (0, 0, 36, 36)), ("webp_rgb.tif", (72, 36), (0, 0, 36, 20), (36, 0, 36, 20)),
    ("webp_rgb.tif", (72, 36), (0, 20, 36, 16), (36, 20, 36, 16))], bands=3)

with open(FOLDER / "expected.txt", "w") as expected:
    print("# file column row samples: as GDAL", rasterio.__gdal_version__, "reads them, by make.py", file=expected)
    for path in sorted(FOLDER.iterdir()):
        if path.suffix not in (".tif", ".vrt") or path.name.startswith("part_"):
            continue
        with rasterio.open(path) as file:
            samples = file.read()
        for _ in range(50):
            x, y = int(rng.integers(WIDTH)), int(rng.integers(HEIGHT))
            print(path.name, x, y, *(repr(v.item()) for v in samples[:, y, x]), file=expected)
