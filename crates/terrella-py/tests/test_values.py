"""Plain values: exact instants, other libraries' objects, pickling."""

import copy
import datetime
import pickle

import numpy as np
import pytest
import terrella

UTC = datetime.timezone.utc
EXACT = "2018-06-21T12:00:00.123456789Z"


def test_instants_keep_their_nanoseconds():
    epoch = terrella.Epoch(EXACT)
    assert epoch.utc == str(epoch) == EXACT and repr(epoch) == f"Epoch('{EXACT}')"
    assert terrella.Epoch("2018-06-21T12:00:00Z").utc == "2018-06-21T12:00:00.000Z"
    assert epoch.to_datetime64() == np.datetime64("2018-06-21T12:00:00.123456789")
    assert epoch.to_datetime() == datetime.datetime(2018, 6, 21, 12, 0, 0, 123_456, UTC)
    assert epoch.nanoseconds_since("2018-06-21T12:00:00Z") == 123_456_789
    for other in [epoch.to_datetime64(), pickle.loads(pickle.dumps(epoch)), copy.deepcopy(epoch)]:
        assert terrella.Epoch(other) == epoch
    whole = terrella.Epoch("2018-06-21T12:00:00Z").to_datetime64()
    assert whole == np.datetime64("2018-06-21T12:00:00") and whole.dtype == np.dtype("datetime64[ns]")


def test_instants_are_subtracted_through_leap_seconds():
    before, after = terrella.Epoch("2016-12-31T23:59:59Z"), terrella.Epoch("2017-01-01T00:00:00Z")
    assert after - before == 2.0 and before - after == -2.0
    assert after - 2.0 == after - datetime.timedelta(seconds=2) == after - np.timedelta64(2, "s") == before
    assert before + np.timedelta64(2_000_000_000, "ns") == 2 + before == after
    assert after - datetime.datetime(2016, 12, 31, 23, 59, 59, tzinfo=UTC) == 2.0
    assert datetime.datetime(2017, 1, 1, tzinfo=UTC) - before == 2.0
    assert after - "2016-12-31T23:59:59Z" == 2.0
    leap = before + 1
    assert leap.utc == "2016-12-31T23:59:60.000Z" and pickle.loads(pickle.dumps(leap)) == leap
    for convert in (leap.to_datetime, leap.to_datetime64):
        with pytest.raises(ValueError, match="leap second"):
            convert()


@pytest.mark.parametrize("elapsed", [1e10, float("nan"), 9e9, -9e9, np.timedelta64("NaT"), datetime.timedelta(days=99999)])
def test_instants_stay_in_range(elapsed):
    with pytest.raises(ValueError, match="elapsed"):
        terrella.Epoch(EXACT) + elapsed
    with pytest.raises(ValueError, match="elapsed"):
        terrella.Epoch(EXACT) - elapsed


def test_what_instants_are_not_compared_with():
    epoch = terrella.Epoch(EXACT)
    assert epoch != EXACT and epoch < epoch + 1 and epoch >= epoch - 1
    for wrong in [lambda: epoch < EXACT, lambda: epoch + EXACT, lambda: epoch - [], lambda: epoch + epoch]:
        with pytest.raises((TypeError, ValueError)):
            wrong()


def test_cameras_are_plain_values():
    looking = terrella.Camera.geodetic(10, 20, 1.2e7, heading_deg=33, pitch_deg=-71, fov_deg=29)
    turned = terrella.Camera.matrices([2e7, 0, 0], np.eye(3), np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0.1], [0, 0, -1, 0]], float))
    for camera in [looking, turned]:
        for other in [pickle.loads(pickle.dumps(camera)), copy.copy(camera)]:
            assert other == camera and hash(other) == hash(camera)
    assert looking != turned and "fov_deg=29" in repr(looking)
    np.testing.assert_allclose(np.linalg.norm(looking.forward), 1, rtol=1e-15)
    np.testing.assert_allclose(turned.forward, [0, 0, -1])
    down = terrella.Camera.geodetic(0, 90, 1e6)
    np.testing.assert_allclose(down.forward, [0, -1, 0], atol=1e-15)
    with pytest.raises(ValueError, match="numbers"):
        terrella.Camera._restored([1.0, 2.0])
    frame = terrella.Frame(np.zeros((2, 3, 4), np.uint8), terrella.Epoch(EXACT))
    again = pickle.loads(pickle.dumps(frame))
    assert again.time == frame.time and np.array_equal(again.color, frame.color)


def test_orbits_of_texts_and_arrays(root):
    path = root / "config/orbits/iss.tle"
    catalogue = terrella.Catalogue.from_text(path.read_text())
    assert catalogue.names == terrella.Catalogue(path).names
    begin, _ = catalogue.validity[0]
    times = [begin + 60.0 * n for n in range(20)]
    positions, velocities = catalogue.propagate(times, "gcrf")
    one = terrella.Ephemerides.from_states(times, positions[0], velocities[0], frame="gcrf", name="ISS")
    assert one.names == ["ISS"] and one.validity == [(times[0], times[-1])] and one.faults == []
    between = [begin + 630.0]
    # Samples of a low orbit at intervals of minutes are interpolated to a few tens of nanometres: docs/orbits.md.
    np.testing.assert_allclose(one.propagate(between)[0], catalogue.propagate(between)[0], atol=1e-5)
    bare = terrella.Ephemerides.from_states(times, positions[0], frame="gcrf")
    np.testing.assert_allclose(bare.propagate(between)[0], catalogue.propagate(between)[0], atol=1e-3)
    assert len(terrella.Ephemerides.from_states(times[:2], positions[0, :2], velocities[0, :2])) == 1
    with pytest.raises(ValueError, match=r"positions_m: an array of shape \(20, 3\)"):
        terrella.Ephemerides.from_states(times, positions[0, :5])
    with pytest.raises(terrella.OrbitError, match="later than"):
        terrella.Ephemerides.from_states(times[::-1], positions[0])
    with pytest.raises(terrella.OrbitError, match="<text>"):
        terrella.Ephemerides.from_text("no orbit", strict=True)


def test_skyfield(root):
    skyfield = pytest.importorskip("skyfield.api", reason="skyfield is not installed")
    scale = skyfield.load.timescale(builtin=True)
    time = scale.utc(2018, 6, 21, 12, 0, 30)
    assert abs(terrella.Epoch(time).nanoseconds_since("2018-06-21T12:00:30Z")) < 100_000
    satellite = skyfield.EarthSatellite(*(root / "config/orbits/iss.tle").read_text().splitlines()[-2:], "ISS", scale)
    begin = satellite.epoch
    row = scale.tai_jd(begin.tai + np.arange(12) / 1440)
    assert terrella.sun_itrf_m(row).shape == (12, 3)
    seen = satellite.at(row)
    flown = terrella.Ephemerides.from_states(row, seen.position, seen.velocity, frame="gcrf")
    np.testing.assert_allclose(flown.propagate(row, "gcrf")[0][0], seen.position.m.T, rtol=1e-9)
    with pytest.raises(ValueError, match="velocities_m_s"):
        terrella.Ephemerides.from_states(row, seen.position, seen.position)


def test_astropy():
    times = pytest.importorskip("astropy.time", reason="astropy is not installed")
    from astropy import units

    for text in ["2018-06-21T12:00:00.123456789", "2016-12-31T23:59:60.5", "1961-01-01T00:00:00", "2099-12-31T23:59:59.999999999"]:
        time = times.Time(text, scale="utc", precision=9)
        epoch = terrella.Epoch(time)
        if text > "1972":
            assert epoch == terrella.Epoch(text + "Z"), text
        assert terrella.Epoch(epoch.to_astropy()) == epoch
        assert abs((epoch.to_astropy() - time).sec) < 1e-9
    row = times.Time("2018-06-21T12:00:00") + np.arange(3) * units.min
    assert terrella.sun_itrf_m(row).shape == (3, 3)
    begin = terrella.Epoch(row[0])
    assert begin + 1 * units.min == begin + (row[1] - row[0]) == terrella.Epoch(row[1])
    orbit = terrella.KeplerOrbit.from_state(row[0], [7000, 0, 0] * units.km, [0, 7.5, 0] * units.km / units.s, last=row[2])
    positions, velocities = orbit.propagate(row[:1], "gcrf")
    np.testing.assert_allclose(positions[0, 0], [7e6, 0, 0], atol=1e-6)
    np.testing.assert_allclose(velocities[0, 0], [0, 7500, 0], atol=1e-9)
    with pytest.raises(ValueError, match="position_m.*not convertible"):
        terrella.KeplerOrbit.from_state(row[0], [7000, 0, 0] * units.kg, [0, 7.5, 0] * units.km / units.s, last=row[2])
    with pytest.raises(ValueError, match="years 1900 to 2099"):
        terrella.Epoch(times.Time("2100-01-01T00:00:01"))
    with pytest.raises(ValueError, match="3 instants where one"):
        terrella.Epoch(row)


def test_xarray(root):
    pytest.importorskip("xarray", reason="xarray is not installed")
    layers = {"range_m": np.ones((2, 3), np.float32), "normal_itrf": np.zeros((2, 3, 3), np.float32)}
    truth = terrella.truth_dataset(layers)
    assert truth["range_m"].dims == ("row", "column") and truth["range_m"].attrs["units"] == "metre"
    assert truth["normal_itrf"].sel(axis="z").shape == (2, 3)
    catalogue = terrella.Catalogue(root / "config/orbits/iss.tle")
    begin, _ = catalogue.validity[0]
    states = terrella.states_dataset(catalogue, [begin, begin + 60], "gcrf")
    assert dict(states.sizes) == {"satellite": 1, "time": 2, "axis": 3} and states.attrs == {"frame": "gcrf"}
    np.testing.assert_array_equal(states["position"].values, catalogue.propagate([begin, begin + 60], "gcrf")[0])
    assert terrella.states_dataset(catalogue, begin).sizes["time"] == 1
