"""Makes the files of tiles of this folder: MBTiles by Python's sqlite3, PMTiles by the reference implementation.

    pip install pmtiles==3.8.1 pillow
    python tests/data/gdal/make_archives.py

Tile x, y (from the north) of level z is of one colour: 30 z, 17 x, 23 y.
"""

import io
import pathlib
import sqlite3

import pmtiles.writer
from PIL import Image
from pmtiles.tile import Compression, TileType, zxy_to_tileid
from pmtiles.writer import Writer

FOLDER = pathlib.Path(__file__).parent
SIDE = 32


def tile(z, x, y, kind="PNG"):
    file = io.BytesIO()
    options = dict(lossless=True) if kind == "WEBP" else {}
    Image.new("RGB", (SIDE, SIDE), (30 * z, 17 * x, 23 * y)).save(file, kind, **options)
    return file.getvalue()


def tiles(levels):
    return [(z, x, y) for z in levels for x in range(1 << z) for y in range(1 << z)]


def mbtiles(name, page_bytes, statements, rows):
    path = FOLDER / name
    path.unlink(missing_ok=True)
    base = sqlite3.connect(path, isolation_level=None)
    base.execute(f"PRAGMA page_size={page_bytes}")
    base.execute("BEGIN")
    for statement in statements:
        base.execute(statement)
    for statement, values in rows:
        base.execute(statement, values)
    base.execute("COMMIT")
    base.execute("VACUUM")
    base.close()


# A table as GDAL and rio-mbtiles write it. One tile is missing; one is long, and lies on pages of its own.
long = bytes(3000)
rows = [("INSERT INTO tiles VALUES (?, ?, ?, ?)", (z, x, (1 << z) - 1 - y, tile(z, x, y) + (long if (x, y) == (1, 1) else b"")))
        for z, x, y in tiles(range(4)) if (z, x, y) != (3, 5, 2)]
mbtiles("table.mbtiles", 512, [
    "CREATE TABLE metadata (name text, value text)",
    "CREATE TABLE tiles (zoom_level integer, tile_column integer, tile_row integer, tile_data blob)",
    "CREATE UNIQUE INDEX tile_index on tiles (zoom_level, tile_column, tile_row)"], rows)
# Two tables, as mbutil writes it; a part of the Earth.
rows = []
for z, x, y in tiles([2]):
    if 1 <= x <= 2 and y >= 1:
        rows.append(("INSERT INTO map VALUES (?, ?, ?, ?, NULL)", (z, x, (1 << z) - 1 - y, f"id-{x}-{y}")))
        rows.append(("INSERT INTO images VALUES (?, ?)", (tile(z, x, y, "WEBP"), f"id-{x}-{y}")))
mbtiles("two_tables.mbtiles", 4096, [
    "CREATE TABLE map (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_id TEXT, grid_id TEXT)",
    "CREATE TABLE images (tile_data blob, tile_id text)",
    "CREATE VIEW tiles AS SELECT map.zoom_level, map.tile_column, map.tile_row, images.tile_data FROM map JOIN images"
    " ON images.tile_id = map.tile_id"], rows)

# Leaves of 20 entries, as files of many tiles have them.
pmtiles.writer.optimize_directories = lambda entries, _: pmtiles.writer.build_roots_leaves(entries, 20)
with open(FOLDER / "tiles.pmtiles", "wb") as file:
    writer = Writer(file)
    for z, x, y in sorted(tiles(range(4)), key=lambda at: zxy_to_tileid(*at)):
        if (z, x, y) != (3, 5, 2):
            writer.write_tile(zxy_to_tileid(z, x, y), tile(z, x, y))
    writer.finalize(dict(
        tile_type=TileType.PNG, tile_compression=Compression.NONE, min_zoom=0, max_zoom=3, min_lon_e7=-1800000000,
        min_lat_e7=-850511287, max_lon_e7=1800000000, max_lat_e7=850511287, center_zoom=0, center_lon_e7=0, center_lat_e7=0), {})
