"""How far a satellite that is integrated from a mean conic is from it after a day: the conic has no terms of short period."""

import numpy as np
import terrella

kepler = terrella.KeplerOrbit(
    "2024-01-01T00:00:00Z", last="2024-01-02T00:00:00Z", semi_major_axis_m=7e6, inclination_deg=51.6, mean_anomaly_deg=0, j2=True
)
positions_m, velocities_m_s = kepler.propagate(["2024-01-01T00:00:00Z"], "gcrf")
flown = terrella.IntegratedOrbit(
    "2024-01-01T00:00:00Z", positions_m[0, 0], velocities_m_s[0, 0], last="2024-01-02T00:00:00Z", air="us1976", sun=True, moon=True
)
last = ["2024-01-02T00:00:00Z"]
off_m = np.linalg.norm(flown.propagate(last)[0] - kepler.propagate(last)[0])
print(f"{off_m / 1e3:.0f} km after a day, {flown.steps} steps")
