"""Where the satellites of a file are for a day: catalogue.py FILE."""

import sys

import numpy as np
import terrella

catalogue = terrella.Catalogue(sys.argv[1])
first, last = catalogue.validity[0]
times = [first + 60.0 * n for n in range(1440)]
positions_m, velocities_m_s = catalogue.propagate(times, "itrf")
places = terrella.geodetic_from_itrf(positions_m)
for name, place in zip(catalogue.names, places):
    print(f"{name}: {place[:, 2].min() / 1e3:.1f} to {place[:, 2].max() / 1e3:.1f} km high, "
          f"to {np.abs(place[:, 0]).max():.2f} degrees from the equator")
