"""A film on two workers: farm_film.py SCENE FOLDER FILM.mp4 [FRAMES]."""

import sys

from terrella import farm

frames = range(int(sys.argv[4])) if len(sys.argv) > 4 else None
report = farm.film(sys.argv[1], sys.argv[2], video=sys.argv[3], size=(640, 360), frames=frames, workers=2)
print(report)
