"""The page of a data set for people: what is in it, how it was drawn, from which maps and under which licences."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

CARD = "README.md"
# The file that describes the starter pack's maps; a copy of the folder has it too.
_SOURCES = "SOURCES.md"
_UNKNOWN = "not stated; the maps are the user's own"


def attribution(textures: Path, files: Sequence[str], pack: Sequence[str]) -> list[dict[str, str]]:
    """Whom to name for the maps and stars of these files of a folder, with their licences; for a pack, what it says itself."""
    if pack:
        return [{"source": line, "licence": "as the source states"} for line in pack]
    page = textures / _SOURCES
    text = page.read_text(encoding="utf-8") if page.is_file() else ""
    licences = dict(re.findall(r"^\| `([^`]+)` \|.*\| ([^|]+) \|$", text, re.MULTILINE))
    named = []
    for name in dict.fromkeys(files):
        section = text.partition(f"\n## {name}\n")[2].partition("\n## ")[0]
        credit = re.search(r"^- Credit: (.*(?:\n  \S.*)*)", section, re.MULTILINE)
        words = " ".join(credit[1].split()).rstrip(".") if credit else name
        named.append({"file": name, "source": words, "licence": licences.get(name, _UNKNOWN)})
    return named


def card(manifest: dict[str, Any]) -> str:
    """A card in Markdown, with the header that Hugging Face reads."""
    width, height = manifest["size"]
    layers = "".join(f"| `{layer['name']}` | {layer['unit']} | {layer['dtype']} | {layer['what']} |\n" for layer in manifest["layers"])
    drawn = "".join(f"| `{name}` | `{words}` |\n" for name, words in manifest["drawn"].items())
    if manifest["draw"]:
        drawn += f"| several, by `draw` | `{manifest['draw']}` |\n"
    if "exposure_ev" not in manifest["drawn"]:
        drawn += f"| `exposure_ev` | the scene's: {manifest['exposure_ev']} |\n"
    named = "".join(f"- {source['source']}: {source['licence']}\n" for source in manifest["attribution"])
    files = "tar shards, as WebDataset reads them" if manifest["kind"] == "webdataset" else "a Zarr group"
    clouds = ""
    if any(layer["name"] == "cloud_cover" for layer in manifest["layers"]):
        clouds = """
`cloud_cover` is the cover of the smooth cloud map. With synthetic detail (`detail` of the scene, on by default) the images show finer clouds than
this label. A scene with `[earth] detail = false` shows the clouds of the label.
"""
    return f"""---
license: other
task_categories: [image-segmentation, depth-estimation]
tags: [synthetic, earth-observation, terrella]
---

# {manifest['count']} rendered images of the Earth

Images of {width} × {height} pixels with the truth of each pixel, rendered by {manifest['program']} from the scene `{manifest['scene']['file']}`.
The files are {files}; `manifest.json` describes them and has their checksums. Clouds, city lights and light are those of a model: the images
show no real date.

| layer | unit | type | what |
|---|---|---|---|
{layers}{clouds}
Each sample depends on the seed, {manifest['seed']}, and its number. Its quantities were drawn from

| quantity | from |
|---|---|
{drawn}
## Attribution and licences

{named or '- none is needed' + chr(10)}
## Reading it

```python
from terrella import farm

data = farm.DataSet("{manifest['name']}")
sample = data[0]
print(sample["color"].shape, data.known(0)["camera"])
```
"""
