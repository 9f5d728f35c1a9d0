"""What type checkers accept: each public call once."""

import datetime
import pickle
from pathlib import Path

import numpy as np
import terrella
from terrella import farm

begin = terrella.Epoch("2018-06-21T12:00:00Z")
seconds: float = begin - np.datetime64("2018-06-21T11:00:00")
later: terrella.Epoch = begin + datetime.timedelta(minutes=1) - 5.0
plain: datetime.datetime = later.to_datetime()
camera = terrella.Camera.geodetic(13, 14, 5e6, heading_deg=270, pitch_deg=-60)
earth = terrella.Earth((64, 36), samples=4, air=False)
dull = terrella.Earth((64, 36), detail=False, directional_reflectance=False)
numbers = dull.raw(camera, begin, {"size": [64, 48], "focal_length_mm": 12.0}).astype(float)
pixels = dull.raw_truth(camera, begin, {"size": [64, 48]}, ["lat_deg"])["lat_deg"]
light = earth.radiance(camera, plain, wait_s=1)
bright: float = float(light.max())
tables: dict[str, dict[str, list[str]]] = {"earth": {"elevation": []}}
truth = terrella.Earth.from_dict(tables, (64, 36)).truth(camera, begin, ["lat_deg"])
earth.frame(camera, begin).save(Path("earth.png"))
scene = terrella.Scene("iss.toml", size=(64, 36))
other: terrella.Scene = terrella.Scene.from_dict({"camera": {"mode": "nadir"}}, folder="config")
with terrella.Film("iss.mp4", scene.size, scene.frame_rate_hz, crf=20) as film:
    for frame in scene.frames(0, 2):
        film.write(frame)
        film.write(frame.color)
catalogue = terrella.Catalogue("iss.tle", strict=True)
positions, velocities = catalogue.propagate([begin, "2018-06-21T12:01:00Z"], "gcrf", outside="nan")
again = terrella.Ephemerides.from_states([begin, later], positions[0], velocities[0], frame="gcrf")
for one in again.passes(48.2, 16.4, first=begin, last=later)[0]:
    print(one["begin"])
pickle.dumps(camera)
terrella.transform(positions, None, begin, source="gcrf", target="itrf")
report = farm.sweep("look.toml", "data", 8, time=farm.Dates("2018-01-01T00:00:00Z", "2019-01-01T00:00:00Z"), sun_elevation_deg=farm.Uniform(10, 80))
print(report.done, farm.DataSet("data")[0]["color"].shape, farm.coco("data", ["land"]))
farm.sweep("look.toml", "one", 8, time=begin)
farm.sweep("look.toml", "two", 8, time=np.datetime64("2018-01-01T00:00:00"))
farm.sweep("look.toml", "three", 8, time=farm.Dates(begin, np.datetime64("2019-01-01T00:00:00")))
farm.film("iss.toml", "frames", frames=range(3))


class LikeAstropy:
    """What type checkers see of a Time of astropy, whose scales are dynamic."""

    jd1: float = 2458119.5
    jd2: float = 0.0
    scale: str = "utc"


terrella.Epoch(LikeAstropy())
