"""A labelled data set on two workers: farm_sweep.py SCENE FOLDER [SAMPLES]."""

import sys

from terrella import farm

count = int(sys.argv[3]) if len(sys.argv) > 3 else 2000
layers = ["lat_deg", "lon_deg", "range_m", "land", "cloud_cover"]
time = farm.Dates("2018-01-01T00:00:00Z", "2019-01-01T00:00:00Z")
pitch_deg, sun_elevation_deg = farm.Normal(-70, 15, -90, -30), farm.Uniform(20, 80)
print(farm.sweep(sys.argv[1], sys.argv[2], count, seed=1, layers=layers, time=time, pitch_deg=pitch_deg, sun_elevation_deg=sun_elevation_deg))
