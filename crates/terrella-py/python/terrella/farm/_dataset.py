"""Data sets of `sweep`, read again: samples as arrays, and masks as COCO has them."""

from __future__ import annotations

import bisect
import io
import json
import operator
import os
import tarfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

from . import _files
from ._report import FarmError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# The pixels of each category, decided by one truth layer. NaN is in no category.
_CATEGORIES: dict[str, tuple[str, Callable[[Any], Any]]] = {
    "land": ("land", lambda land: land >= 0.5),
    "water": ("land", lambda land: land < 0.5),
    "cloud": ("cloud_cover", lambda cover: cover >= 0.5),
    "night": ("sun_elevation_deg", lambda elevation_deg: elevation_deg < 0),
    "earth": ("range_m", lambda range_m: range_m > 0),
}


class DataSet:
    """A complete data set that ``sweep`` wrote, of either format: ``len``, and samples by their numbers.

    >>> data = farm.DataSet("data")
    >>> sample = data[0]
    >>> sample["color"].shape, sample["range_m"].dtype, data.known(0)["time_utc"]

    Negative numbers count from the end, and a slice gives a list.

    A sample is a dict of arrays: ``color``, height × width × 3 bytes, and each layer. PyTorch's ``DataLoader`` takes it as it is, with any number of
    workers. Pictures of WebDataset shards need Pillow.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        path = self.folder / "manifest.json"
        try:
            self.manifest: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise FarmError(f"{path}: is no manifest of a sweep: {error}") from error
        if not self.manifest.get("complete"):
            raise FarmError(f"{path}: the data set is not complete; run the same sweep again")
        self.layers: list[str] = [layer["name"] for layer in self.manifest["layers"]]
        self._firsts = [shard["first"] for shard in self.manifest["shards"]]
        # The offsets of a tar's members, or the lines of a Zarr page. Read on first access to the shard.
        self._read: dict[int, Any] = {}

    def __len__(self) -> int:
        count: int = self.manifest["count"]
        return count

    def __repr__(self) -> str:
        width, height = self.manifest["size"]
        return f"<terrella.farm.DataSet {self.folder}, {len(self)} samples of {width} × {height}: color, {', '.join(self.layers)}>"

    @overload
    def __getitem__(self, index: SupportsIndex) -> dict[str, NDArray[Any]]: ...
    @overload
    def __getitem__(self, index: slice) -> list[dict[str, NDArray[Any]]]: ...
    def __getitem__(self, index: SupportsIndex | slice) -> dict[str, NDArray[Any]] | list[dict[str, NDArray[Any]]]:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        index = self._number(index)
        color = self._chunk("color", index) if self._is_zarr() else _decoded(self._member(index, "png"))
        return {"color": color, **self.truth(index)}

    def truth(self, index: SupportsIndex) -> dict[str, NDArray[Any]]:
        """The layers of a sample without its picture."""
        import numpy as np

        index = self._number(index)
        if self._is_zarr():
            return {name: self._chunk(name, index) for name in self.layers}
        return {name: np.load(io.BytesIO(self._member(index, f"{name}.npy"))) for name in self.layers}

    def known(self, index: SupportsIndex) -> dict[str, Any]:
        """What is known of a sample besides its arrays: time, camera, exposure, the Sun."""
        index = self._number(index)
        if not self._is_zarr():
            known: dict[str, Any] = json.loads(self._member(index, "json"))
            return known
        shard = self._shard(index)
        if shard not in self._read:
            lines = (self.folder / self.manifest["shards"][shard]["file"]).read_text(encoding="utf-8").splitlines()
            self._read[shard] = [json.loads(line) for line in lines]
        known = dict(self._read[shard][index - self._firsts[shard]])
        del known["chunks"]
        return known

    def _is_zarr(self) -> bool:
        return bool(self.manifest["kind"] == "zarr")

    def _number(self, index: SupportsIndex) -> int:
        """The number of a sample; negative ones count from the end."""
        try:
            number = operator.index(index)
        except TypeError:
            raise TypeError(f"index: a sample's number is needed, not {type(index).__name__}") from None
        if not -len(self) <= number < len(self):
            raise IndexError(f"index: {number} is not from {-len(self)} to {len(self) - 1}")
        return number % len(self)

    def _shard(self, index: int) -> int:
        return bisect.bisect_right(self._firsts, index) - 1

    def _member(self, index: int, ending: str) -> bytes:
        shard = self._shard(index)
        path = self.folder / self.manifest["shards"][shard]["file"]
        if shard not in self._read:
            with tarfile.open(path) as tar:
                self._read[shard] = {entry.name: (entry.offset_data, entry.size) for entry in tar}
        offset, size = self._read[shard][f"{index:09}.{ending}"]
        with open(path, "rb") as file:
            file.seek(offset)
            return file.read(size)

    def _chunk(self, name: str, index: int) -> NDArray[Any]:
        import numpy as np

        array = json.loads((self.folder / name / ".zarray").read_text(encoding="utf-8"))
        shape = array["chunks"][1:]
        chunk = self.folder / name / ".".join([str(index), *("0" for _ in shape)])
        return np.fromfile(chunk, array["dtype"]).reshape(shape)


def coco(
    folder: str | os.PathLike[str], categories: Sequence[str] = ("land", "cloud"), out: str | os.PathLike[str] | None = None
) -> Path:
    """Writes masks of a complete data set in COCO's format and returns the path of the file: `annotations.json` in the folder, or `out`.

    `categories` are any of "land", "water", "cloud", "night" and "earth", from the truth layers `land`, `cloud_cover`, `sun_elevation_deg` and
    `range_m`, which the data set must have. Each is one mask of an image (`iscrowd` 1, uncompressed run lengths), left out where it is empty. A
    `file_name` is the image's shard and its name in it.
    """
    if isinstance(categories, str):
        raise TypeError(f"categories: pass a list of names, for example [{categories!r}], not a text")
    data = DataSet(folder)
    for name in categories:
        if name not in _CATEGORIES:
            raise ValueError(f"categories: {name!r} is none of {', '.join(_CATEGORIES)}")
        if (layer := _CATEGORIES[name][0]) not in data.layers:
            raise ValueError(f"categories: {name!r} needs the layer {layer}; the data set has {', '.join(data.layers)}")
    width, height = data.manifest["size"]
    images, annotations = [], []
    for index in range(len(data)):
        layers = data.truth(index)
        shard = data.manifest["shards"][data._shard(index)]["file"]
        images.append({"id": index, "width": width, "height": height, "file_name": f"{shard}/{index:09}.png",
                       "date_captured": data.known(index)["time_utc"], "license": 1})
        for number, name in enumerate(categories, 1):
            layer, is_in = _CATEGORIES[name]
            if (mask := is_in(layers[layer])).any():
                annotations.append({"id": len(annotations) + 1, "image_id": index, "category_id": number, "iscrowd": 1, **_run_lengths(mask)})
    licence = "; ".join(dict.fromkeys(source["licence"] for source in data.manifest["attribution"]))
    page = {
        "info": {"description": f"Terrella sweep of {data.manifest['scene']['file']}", "version": data.manifest["program"]},
        "licenses": [{"id": 1, "name": licence}],
        "categories": [{"id": number, "name": name} for number, name in enumerate(categories, 1)],
        "images": images,
        "annotations": annotations,
    }
    path = data.folder / "annotations.json" if out is None else Path(out)
    _files.write_whole(path, json.dumps(page, ensure_ascii=False).encode() + b"\n")
    return path


def _run_lengths(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """A mask's run lengths down its columns, beginning with what is outside, its area, and the box around it."""
    import numpy as np

    pixels = mask.ravel(order="F")
    edges = np.flatnonzero(pixels[1:] != pixels[:-1]) + 1
    counts = np.diff([0, *edges, pixels.size]).tolist()
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return {
        "segmentation": {"size": list(mask.shape), "counts": [0, *counts] if pixels[0] else counts},
        "area": int(mask.sum()),
        "bbox": [int(columns[0]), int(rows[0]), int(columns[-1] - columns[0] + 1), int(rows[-1] - rows[0] + 1)],
    }


def _decoded(png: bytes) -> NDArray[np.uint8]:
    import numpy as np

    try:
        from PIL import Image
    except ImportError as error:
        raise FarmError("pictures of a WebDataset are PNG, which Pillow reads; pip install pillow") from error
    return np.array(Image.open(io.BytesIO(png)))
