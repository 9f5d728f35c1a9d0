"""Flies a satellite with nyx-space, writes its ephemeris as nyx writes files, and a table of the places between its states.

    pip install nyx-space==2.6.0
    python with_nyx.py SPK BPC TPC [FOLDER]

Three SPICE kernels: planets (`de405.bsp`), the Earth's orientation (`earth_latest_high_prec.bpc`), planetary constants
(`pck00011.tpc`). The wheel of gmatpy 0.2.1 holds all three.
"""

import sys
import tempfile
from pathlib import Path

from nyx_space import Orbit, Spacecraft
from nyx_space.anise import Almanac, astro, utils
from nyx_space.anise.constants import CelestialObjects, Frames
from nyx_space.mission_design import AccelModels, Dynamics, ForceModels, PointMasses, Propagator
from nyx_space.time import Duration, Epoch, TimeSeries, Unit

SPK, BPC, TPC = sys.argv[1:4]
OUT = Path(sys.argv[4] if len(sys.argv) > 4 else ".")

# nyx takes constants in a format of its own, made of two kernels.
MASSES = r"""KPL/PCK
\begindata
BODY10_GM = ( 1.32712440018E+11 )
BODY301_GM = ( 4.902801076E+03 )
BODY399_GM = ( 3.986004415E+05 )
\begintext
"""
with tempfile.TemporaryDirectory() as folder:
    masses, constants = Path(folder) / "gm.tpc", Path(folder) / "constants.pca"
    masses.write_text(MASSES)
    utils.convert_tpc(TPC, str(masses), str(constants), True)
    almanac = Almanac(SPK).load(BPC).load(str(constants))

shape = astro.Ellipsoid(6378.137, 6356.752314245179, 6378.137)
eme2000 = astro.Frame(399, 1, mu_km3_s2=398600.4415, shape=shape)
itrf = astro.Frame(399, 3000, mu_km3_s2=398600.4415, shape=shape)
start, end = Epoch("2016-12-24T23:10:00 UTC"), Epoch("2016-12-25T00:40:00 UTC")
orbit = Orbit.from_keplerian(6928.0, 0.004, 97.6, 120.0, 70.0, 5.0, start, eme2000)
pull = PointMasses([CelestialObjects.SUN, CelestialObjects.MOON])
propagator = Propagator(Dynamics(AccelModels(point_masses=pull), ForceModels()), almanac)
trajectory = propagator.until_epoch(Spacecraft(orbit), end).trajectory
ephemeris = trajectory.to_ephemeris("2016-999C")

# As nyx gives it: a state at every step of the integrator, of uneven lengths.
ephemeris.write_ccsds_oem(str(OUT / "nyx_steps.oem"), "NYX USER", "NYX LOW")
minutes = ephemeris.resample(TimeSeries(start, end, Unit.Minute * 1, True), almanac)
for name, frame in [("itrf93", itrf), ("icrs", Frames.GCRF), ("teme", Frames.EARTH_TEME_FRAME)]:
    minutes.transform(frame, almanac).write_ccsds_oem(str(OUT / f"nyx_{name}.oem"), "NYX USER", "NYX LOW")

frames = {"eme2000": eme2000, "gcrf": Frames.GCRF, "teme": Frames.EARTH_TEME_FRAME, "itrf": itrf}
rows = [",".join(["epoch_utc", *(f"{f}_{a}_m" for f in frames for a in "xyz"), "lat_deg", "lon_deg", "height_m"])]
epoch = start + Duration("311.5 s")
while epoch < end - Duration("300 s"):
    state = trajectory.at(epoch).orbit
    numbers = []
    for frame in frames.values():
        turned = almanac.transform_to(state, frame)
        numbers += [1e3 * turned.x_km, 1e3 * turned.y_km, 1e3 * turned.z_km]
    place = almanac.transform_to(state, itrf).latlongalt()
    text = [f"{v:.5f}" for v in numbers] + [f"{v:.10f}" for v in place[:2]] + [f"{place[2] * 1e3:.5f}"]
    rows.append(",".join([epoch.strftime("%Y-%m-%dT%H:%M:%S.%f")[:23] + "Z", *text]))
    epoch = epoch + Duration("67 s")
(OUT / "nyx.places.csv").write_text("\n".join(rows) + "\n")
