"""The Earth from a place of your choice, and what its pixels show."""

import numpy as np
import terrella

earth = terrella.Earth((640, 360), samples=4)
camera = terrella.Camera.geodetic(13, 14, 5e6, heading_deg=270, pitch_deg=-60)
time = "2018-06-21T18:00:00Z"
earth.frame(camera, time).save("earth.png")
light = earth.radiance(camera, time)
truth = earth.truth(camera, time, ["lat_deg", "lon_deg", "lit"])
print(f"brightest {light.max():.2f}, {np.nanmean(truth['lit']):.0%} of the ground in view is lit")
