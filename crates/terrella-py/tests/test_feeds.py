"""Satellites as arrays, frames and time."""

import datetime

import numpy as np
import pytest
import terrella

ISS = "config/orbits/iss.tle"


def test_a_catalogue_is_propagated(root):
    catalogue = terrella.Catalogue(root / ISS)
    first, _ = catalogue.validity[0]
    times = [first + datetime.timedelta(minutes=n) for n in range(90)]
    positions, velocities = catalogue.propagate(times)
    assert positions.shape == velocities.shape == (len(catalogue), 90, 3)
    assert positions.dtype == np.float64
    heights = terrella.geodetic_from_itrf(positions)[..., 2]
    assert (heights > 1.5e5).all()
    assert len(catalogue.names) == len(catalogue)


def test_velocities_are_those_of_the_frame(root):
    catalogue = terrella.Catalogue(root / ISS)
    first, _ = catalogue.validity[0]
    middle = first + 3600.0
    times = [middle, middle + 0.5, middle + 1.0]
    for frame in ("itrf", "teme", "gcrf"):
        positions, velocities = catalogue.propagate(times, frame)
        found = positions[0, 2] - positions[0, 0]
        np.testing.assert_allclose(found, velocities[0, 1], atol=0.05)


def test_frames_come_back(root):
    positions = np.array([[7e6, 1e6, 2e6], [0, 0, 8e6]])
    velocities = np.array([[0, 7e3, 0], [1e3, 0, 0]])
    time = "2020-01-01T00:00:00Z"
    there = terrella.transform(positions, velocities, time, source="teme", target="itrf")
    back = terrella.transform(*there, time, source="itrf", target="teme")
    np.testing.assert_allclose(back[0], positions, atol=1e-6)
    np.testing.assert_allclose(back[1], velocities, atol=1e-9)
    alone, none = terrella.transform(positions, None, time, source="teme", target="itrf")
    assert none is None
    np.testing.assert_array_equal(alone, there[0])
    with pytest.raises(ValueError, match="times: 3 instants for 2"):
        terrella.transform(positions, None, [time] * 3, source="teme", target="itrf")
    with pytest.raises(ValueError, match="source"):
        terrella.transform(positions, None, time, source="mars", target="itrf")


def test_places():
    positions = terrella.itrf_from_geodetic([[0, 0, 0], [90, 0, 100], [-33.9, 151.2, 50]])
    np.testing.assert_allclose(positions[0], [6_378_137, 0, 0], atol=1e-6)
    np.testing.assert_allclose(positions[1], [0, 0, 6_356_852.314], atol=1e-3)
    places = terrella.geodetic_from_itrf(positions)
    np.testing.assert_allclose(places[2], [-33.9, 151.2, 50], atol=1e-8)
    with pytest.raises(ValueError, match="places"):
        terrella.itrf_from_geodetic([91, 0, 0])
    with pytest.raises(ValueError, match="positions_m"):
        terrella.geodetic_from_itrf([1, 2])


def test_the_sun_is_over_the_tropic_at_solstice():
    sun = terrella.sun_itrf_m(["2018-06-21T10:07:00Z"])[0]
    declination = np.degrees(np.arcsin(sun[2] / np.linalg.norm(sun)))
    assert abs(declination - 23.43) < 0.02
    assert 1.5e11 < np.linalg.norm(sun) < 1.53e11


def test_instants_are_one_however_they_are_written():
    utc = datetime.timezone.utc
    wanted = terrella.Epoch("2018-06-21T12:00:00.25Z")
    for other in [
        datetime.datetime(2018, 6, 21, 12, 0, 0, 250_000, utc),
        datetime.datetime(2018, 6, 21, 14, 0, 0, 250_000, datetime.timezone(datetime.timedelta(hours=2))),
        np.datetime64("2018-06-21T12:00:00.25"),
        np.datetime64("2018-06-21T12:00:00.250000000"),
        wanted,
    ]:
        assert terrella.Epoch(other) == wanted
        assert hash(terrella.Epoch(other)) == hash(wanted)


def test_scales_and_leap_seconds():
    before = terrella.Epoch("2016-12-31T23:59:60.5Z")
    after = terrella.Epoch("2017-01-01T00:00:00.5Z")
    assert after.seconds_since(before) == 1.0
    assert before < after
    assert (before + 1.0) == after
    assert (terrella.Epoch(np.datetime64("2016-12-31T23:59:59.5")) + 1.0) == before
    tai = terrella.readings([after], "TAI")
    assert tai.dtype == np.dtype("datetime64[ns]")
    assert tai[0] == np.datetime64("2017-01-01T00:00:37.5")
    assert terrella.readings([after], "GPS")[0] == np.datetime64("2017-01-01T00:00:18.5")
    assert terrella.readings([after], "TT")[0] == np.datetime64("2017-01-01T00:01:09.684")
    assert after.text("TAI").startswith("2017-01-01T00:00:37.5")
    with pytest.raises(ValueError, match="scale"):
        terrella.readings([after], "UTC")
    with pytest.raises(ValueError, match="scale"):
        after.text("local")


def test_scenes_have_states(scene):
    positions, velocities = scene.propagate(scene.times()[:10])
    assert positions.shape == (len(scene.satellites), 10, 3)
    assert 6.6e6 < np.linalg.norm(positions[0, 0]) < 6.9e6
    nothing, _ = scene.propagate(["2050-01-01T00:00:00Z"], outside="nan")
    assert np.isnan(nothing).all()
    with pytest.raises(terrella.OrbitError):
        scene.propagate(["2050-01-01T00:00:00Z"])
    with pytest.raises(ValueError, match="outside"):
        scene.propagate(scene.start, outside="ignore")
    with pytest.raises(ValueError, match="frame"):
        scene.propagate(scene.start, "j2000")


def test_passes_have_what_is_seen_of_them(root):
    catalogue = terrella.Catalogue(root / ISS)
    options = {"first": "2018-01-25T00:00:00Z", "last": "2018-01-26T00:00:00Z"}
    (passes,) = catalogue.passes(48.2, 16.4, 200.0, standard_magnitude=-1.8, **options)
    seen = [one for one in passes if one["visible"]]
    assert len(passes) > len(seen) == 1
    (visible,) = seen[0]["visible"]
    # Skyfield 1.55 with DE421, as in crates/terrella-orbit/src/visible_tests.rs.
    assert abs(visible["begin"].seconds_since("2018-01-25T17:12:40.917Z")) < 1
    assert abs(visible["end"].seconds_since("2018-01-25T17:13:47.782Z")) < 1
    assert abs(visible["magnitude"] + 1.573) < 0.01
    for one in passes:
        assert one["elevation_deg"] > 10 and one["rises"] and one["sets"]
        assert 0 < one["duration_s"] < 600
    (plain,) = catalogue.passes(48.2, 16.4, 200.0, **options)
    assert [one["magnitude"] for each in plain for one in each["visible"]] == [None]
    with pytest.raises(ValueError, match="lat_deg"):
        catalogue.passes(91, 0, **options)
    with pytest.raises(ValueError, match="min_elevation_deg"):
        catalogue.passes(0, 0, min_elevation_deg=90, **options)


OPM = """CCSDS_OPM_VERS = 2.0
CREATION_DATE = 2018-01-01T00:00:00
ORIGINATOR = TEST
OBJECT_NAME = SAT
OBJECT_ID = 2018-001A
CENTER_NAME = EARTH
REF_FRAME = EME2000
TIME_SYSTEM = UTC
EPOCH = 2018-01-01T00:00:00
X = 6778.137
Y = 0
Z = 0
X_DOT = 0
Y_DOT = 4.7
Z_DOT = 6.05
"""


def test_parameter_messages_are_integrated(tmp_path):
    path = tmp_path / "sat.opm"
    path.write_text(OPM)
    first = "2018-01-01T00:00:00Z"
    messages = terrella.ParameterMessages(path, last="2018-01-01T02:00:00Z")
    assert messages.names == ["SAT"] and messages.faults == []
    positions, velocities = messages.propagate([first], "eme2000")
    np.testing.assert_allclose(positions[0, 0], [6_778_137, 0, 0], atol=1e-3)
    np.testing.assert_allclose(velocities[0, 0], [0, 4_700, 6_050], atol=1e-6)
    with pytest.raises(terrella.OrbitError):
        messages.propagate(["2018-01-02T00:00:00Z"])
    with pytest.raises(terrella.OrbitError, match="missing.opm"):
        terrella.ParameterMessages(tmp_path / "missing.opm", last=first)
