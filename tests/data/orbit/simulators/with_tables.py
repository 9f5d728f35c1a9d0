"""Writes tables of states with skyfield, astropy and hapsira (which goes on with poliastro), and of places between them.

    pip install skyfield==1.55 astropy==8.0.2 sgp4==2.27 hapsira==0.18.0
    python with_tables.py [FOLDER]
"""

import sys
from datetime import datetime, timedelta, timezone
from pathlib import Path

import numpy as np
from astropy import units as u
from astropy.coordinates import GCRS, ITRS, TEME, CartesianDifferential, CartesianRepresentation, EarthLocation
from astropy.time import Time
from astropy.utils import iers
from sgp4.api import Satrec
from skyfield.api import EarthSatellite, load, wgs84
from skyfield.framelib import itrs

iers.conf.auto_download = False
OUT = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
# An orbit like the space station's.
LINES = (
    "1 99999U 16999D   16359.95833333  .00002078  00000-0  38550-4 0  9992",
    "2 99999  51.6424  32.9776 0003646  28.7227  39.5332 15.54190080    19",
)
START = datetime(2016, 12, 24, 23, 10, tzinfo=timezone.utc)
minutes = [START + timedelta(minutes=k) for k in range(91)]
between = [START + timedelta(seconds=311.5 + 67 * k) for k in range(73)]


def text(date):
    return date.strftime("%Y-%m-%dT%H:%M:%S.%f")[:-3] + "Z"


def write(name, frame, dates, r_km, v_km_s):
    """A table that Terrella reads."""
    rows = [f"# frame = {frame}, name = {name}", "epoch_utc,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s"]
    for date, r, v in zip(dates, r_km.T, v_km_s.T):
        rows.append(",".join([text(date), *map(repr, map(float, [*r, *v]))]))
    (OUT / f"{name}.csv").write_text("\n".join(rows) + "\n")


def places(name, frames, geodetic):
    """A table that the test reads."""
    rows = [",".join(["epoch_utc", *(f"{f}_{a}_m" for f in frames for a in "xyz"), "lat_deg", "lon_deg", "height_m"])]
    for k, date in enumerate(between):
        numbers = [f"{v * 1e3:.5f}" for r in frames.values() for v in r[:, k]]
        below = [f"{geodetic[0][k]:.10f}", f"{geodetic[1][k]:.10f}", f"{geodetic[2][k]:.5f}"]
        rows.append(",".join([text(date), *numbers, *below]))
    (OUT / f"{name}.places.csv").write_text("\n".join(rows) + "\n")


# skyfield: positions from the Earth's centre are in GCRF.
times = load.timescale(builtin=True)
satellite = EarthSatellite(*LINES, "SKYFIELD", times)
seen = satellite.at(times.from_datetimes(minutes))
write("skyfield", "GCRF", minutes, seen.position.km, seen.velocity.km_per_s)
seen = satellite.at(times.from_datetimes(between))
below = wgs84.geographic_position_of(seen)
places(
    "skyfield",
    {"gcrf": seen.position.km, "itrf": seen.frame_xyz(itrs).km},
    (below.latitude.degrees, below.longitude.degrees, below.elevation.m),
)

# astropy: any frame; here TEME, which SGP4 gives, made ITRS.
elements = Satrec.twoline2rv(*LINES)


def in_itrs(dates):
    time = Time([date.replace(tzinfo=None) for date in dates], scale="utc")
    _, r, v = elements.sgp4_array(time.jd1, time.jd2)
    speed = CartesianDifferential(v.T * u.km / u.s)
    state = TEME(CartesianRepresentation(r.T * u.km, differentials=speed), obstime=time)
    return state, state.transform_to(ITRS(obstime=time))


_, state = in_itrs(minutes)
write("astropy", "ITRF", minutes, state.cartesian.xyz.to_value(u.km), state.velocity.d_xyz.to_value(u.km / u.s))
_, state = in_itrs(between)
below = EarthLocation.from_geocentric(*state.cartesian.xyz).to_geodetic("WGS84")
places(
    "astropy",
    {"itrf": state.cartesian.xyz.to_value(u.km)},
    (below.lat.deg, below.lon.deg, below.height.to_value(u.m)),
)
