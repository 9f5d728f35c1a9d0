"""Shards of a data set: units of work that are there whole or not at all."""

from __future__ import annotations

import io
import json
import shutil
import tarfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from .. import _native
from . import _files

Samples = Iterator[tuple[int, dict[str, Any], Any, dict[str, Any]]]
Note = Callable[[dict[str, Any]], None]


def _json(value: dict[str, Any]) -> bytes:
    return json.dumps(value, ensure_ascii=False).encode()


def _npy(array: Any) -> bytes:
    import numpy as np

    file = io.BytesIO()
    np.lib.format.write_array(file, np.ascontiguousarray(array), version=(1, 0), allow_pickle=False)
    return file.getvalue()


class WebDataset:
    """Tar files, as WebDataset reads them: of each sample `000000042.png`, `000000042.LAYER.npy` and `000000042.json`.

    >>> for sample in webdataset.WebDataset("data/shard-{000000..000031}.tar", shardshuffle=False).decode():
    ...     range_m, known = sample["range_m.npy"], sample["json"]

    Equal samples give equal files: no times and no owners are in them.
    """

    def name(self, shard: int) -> str:
        return f"shard-{shard:06}.tar"

    def path(self, out: Path, shard: int) -> Path:
        return out / self.name(shard)

    def begin(self, out: Path, definition: dict[str, Any]) -> None:
        pass

    def remove(self, out: Path) -> None:
        for path in out.glob("shard-*.tar"):
            path.unlink()

    def is_whole(self, out: Path, shard: dict[str, Any]) -> bool:
        path = self.path(out, shard["shard"])
        return path.is_file() and path.stat().st_size == shard["bytes"] and _files.checksum(path) == shard["sha256"]

    def write(self, out: Path, part: dict[str, Any], adapter: str, samples: Samples, note: Note) -> dict[str, Any]:
        number = part["shard"]
        shard: dict[str, Any] = {}
        with _files.pending(self.path(out, number)) as (file, before):
            with tarfile.open(fileobj=file, mode="w|", format=tarfile.USTAR_FORMAT) as tar:
                for index, known, color, layers in samples:
                    _add(tar, f"{index:09}.png", _native.png(color))
                    for name, values in layers.items():
                        _add(tar, f"{index:09}.{name}.npy", _npy(values))
                    _add(tar, f"{index:09}.json", _json(known))

            def finish() -> None:
                shard.update(shard=number, file=self.name(number), first=part["first"], samples=part["samples"], bytes=file.bytes,
                             sha256=file.sha256, adapter=adapter)
                note(shard)

            before.append(finish)
        return shard


def _add(tar: tarfile.TarFile, name: str, contents: bytes) -> None:
    entry = tarfile.TarInfo(name)
    entry.size, entry.mode, entry.mtime = len(contents), 0o644, 0
    tar.addfile(entry, io.BytesIO(contents))


class Zarr:
    """A Zarr group (format 2, which all versions of zarr read): `color`, one array for each layer, and what is known of each sample.

    A chunk is a sample, uncompressed, so that workers write none together. A shard is whole when its page `samples/NNNNNN.jsonl` is there,
    which has the checksum of each chunk.
    """

    def name(self, shard: int) -> str:
        return f"samples/{shard:06}.jsonl"

    def path(self, out: Path, shard: int) -> Path:
        return out / self.name(shard)

    def begin(self, out: Path, definition: dict[str, Any]) -> None:
        width, height = definition["size"]
        count = definition["count"]
        arrays = {"color": ("|u1", (3,), 0)}
        for layer in definition["layers"]:
            axes = (3,) if layer["name"] == "normal_itrf" else ()
            arrays[layer["name"]] = (layer["dtype"], axes, "NaN")
        (out / "samples").mkdir(exist_ok=True)
        _files.write_whole(out / ".zgroup", _json({"zarr_format": 2}))
        _files.write_whole(out / ".zattrs", _json({"manifest": "manifest.json"}))
        units = {layer["name"]: layer for layer in definition["layers"]}
        for name, (dtype, axes, fill) in arrays.items():
            (out / name).mkdir(exist_ok=True)
            shape = [count, height, width, *axes]
            _files.write_whole(out / name / ".zarray", _json({
                "zarr_format": 2, "shape": shape, "chunks": [1, *shape[1:]], "dtype": dtype, "compressor": None, "fill_value": fill,
                "order": "C", "filters": None, "dimension_separator": "."}))
            # xarray names the axes by it.
            attributes = {"_ARRAY_DIMENSIONS": ["sample", "row", "column", *(["axis"] if axes or name == "color" else [])]}
            _files.write_whole(out / name / ".zattrs", _json(attributes | units.get(name, {})))

    def remove(self, out: Path) -> None:
        for path in out.iterdir():
            if (path / ".zarray").is_file() or path.name == "samples":
                shutil.rmtree(path)

    def is_whole(self, out: Path, shard: dict[str, Any]) -> bool:
        path = self.path(out, shard["shard"])
        if not path.is_file() or _files.checksum(path) != shard["sha256"]:
            return False
        for line in path.read_bytes().splitlines():
            for name, (length, digest) in json.loads(line)["chunks"].items():
                chunk = out / name
                if not chunk.is_file() or chunk.stat().st_size != length or _files.checksum(chunk) != digest:
                    return False
        return True

    def write(self, out: Path, part: dict[str, Any], adapter: str, samples: Samples, note: Note) -> dict[str, Any]:
        import numpy as np

        number = part["shard"]
        shard: dict[str, Any] = {}
        total = 0
        with _files.pending(self.path(out, number)) as (page, before):
            for index, known, color, layers in samples:
                chunks = {}
                for name, values in {"color": color[..., :3], **layers}.items():
                    chunk = f"{name}/{index}" + ".0" * (np.ndim(values) if name == "color" or np.ndim(values) == 3 else 2)
                    # Chunks are many and small. The checksum detects one that a power failure damaged, and its shard is written again.
                    with _files.pending(out / chunk, durable=False) as (file, _):
                        file.write(np.ascontiguousarray(values).tobytes())
                    chunks[chunk] = (file.bytes, file.sha256)
                    total += file.bytes
                page.write(_json({**known, "chunks": chunks}) + b"\n")

            def finish() -> None:
                shard.update(shard=number, file=self.name(number), first=part["first"], samples=part["samples"], bytes=total + page.bytes,
                             sha256=page.sha256, adapter=adapter)
                note(shard)

            before.append(finish)
        return shard


FORMATS: dict[str, Any] = {"webdataset": WebDataset(), "zarr": Zarr()}
