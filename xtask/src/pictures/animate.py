"""Writes the PNG frames of folders as one animated WebP: its path, the milliseconds of a frame, the folders."""

import pathlib
import sys

try:
    from PIL import Image
except ImportError:
    sys.exit("animated WebP needs Pillow: python3 -m pip install pillow")

path, frame_ms, *folders = sys.argv[1:]
files = [file for folder in folders for file in sorted(pathlib.Path(folder).glob("*.png"))]
first, *rest = [Image.open(file).convert("RGB") for file in files]
first.save(path, save_all=True, append_images=rest, duration=int(frame_ms), loop=0, quality=75, method=6)
