"""A film of a scene with a progress bar: film.py SCENE FILM [FRAMES]."""

import sys

import terrella
from tqdm import tqdm

frames = int(sys.argv[3]) if len(sys.argv) > 3 else None
scene = terrella.Scene(sys.argv[1], size=(640, 360))
with terrella.Film(sys.argv[2], scene.size, scene.frame_rate_hz) as film:
    for time in tqdm(scene.times()[:frames]):
        film.write(scene.frame(time))
