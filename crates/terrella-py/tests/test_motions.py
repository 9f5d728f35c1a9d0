"""Motions without a file: on conics, and integrated."""

import numpy as np
import pytest
import terrella

START = "2024-01-01T00:00:00Z"
LAST = "2024-01-02T00:00:00Z"
GM_M3_S2 = 3.986004418e14


def elements(**more):
    given = dict(last=LAST, semi_major_axis_m=7e6, eccentricity=0.01, inclination_deg=51.6, mean_anomaly_deg=0.0)
    return terrella.KeplerOrbit(START, **{**given, **more})


def test_a_conic_comes_round():
    orbit = elements()
    assert isinstance(orbit, terrella.Satellites)
    assert (len(orbit), orbit.names, orbit.impact) == (1, ["satellite"], None)
    period_s = 2 * np.pi * np.sqrt(7e6**3 / GM_M3_S2)
    start = terrella.Epoch(START)
    positions, velocities = orbit.propagate([start, start + period_s / 2, start + period_s], "gcrf")
    assert positions.shape == velocities.shape == (1, 3, 3)
    distances = np.linalg.norm(positions[0], axis=1)
    np.testing.assert_allclose(distances, [6.93e6, 7.07e6, 6.93e6], atol=1e-3)
    np.testing.assert_allclose(positions[0, 2], positions[0, 0], atol=0.05)
    # The state gives the same conic.
    again = terrella.KeplerOrbit.from_state(START, positions[0, 0], velocities[0, 0], last=LAST)
    np.testing.assert_allclose(again.propagate([LAST], "gcrf")[0], orbit.propagate([LAST], "gcrf")[0], atol=1e-3)
    # J2 moves the node west by 5.0 degrees a day.
    drifted = elements(j2=True).propagate([LAST], "gcrf")
    node = np.cross(drifted[0][0, 0], drifted[1][0, 0])
    assert -5.1 < np.degrees(np.arctan2(node[0], -node[1])) < -4.3


def test_a_point_mass_is_integrated_to_the_conic():
    orbit = elements()
    positions, velocities = orbit.propagate([START], "gcrf")
    state = (START, positions[0, 0], velocities[0, 0])
    point = terrella.IntegratedOrbit(*state, last=LAST, gravity_degree=0, relative_tolerance=1e-12)
    times = [terrella.Epoch(START) + 3600.0 * n for n in range(25)]
    off_m = np.linalg.norm(point.propagate(times, "gcrf")[0] - orbit.propagate(times, "gcrf")[0], axis=2)
    assert off_m.max() < 0.1
    assert point.steps > 100
    # Gravity field, air, Sun, Moon and sunlight each change the orbit.
    ends = [point.propagate([LAST], "gcrf")[0]]
    for more in [dict(gravity_degree=8), dict(air="us1976"), dict(sun=True), dict(moon=True), dict(sunlight=True)]:
        moved = terrella.IntegratedOrbit(*state, last=LAST, **{"gravity_degree": 0, **more})
        ends.append(moved.propagate([LAST], "gcrf")[0])
    for n, end in enumerate(ends):
        assert all(np.linalg.norm(end - other) > 0.05 for other in ends[:n]), n
    low = terrella.IntegratedOrbit(START, [6.48e6, 0, 0], [0, 7.8e3, 0], last=LAST, air="us1976")
    assert low.impact is not None and low.impact < terrella.Epoch(LAST)
    with pytest.raises(terrella.OrbitError):
        low.propagate([LAST])


@pytest.mark.parametrize(
    "wrong, said",
    [
        (dict(periapsis_m=7e6), "semi_major_axis_m, periapsis_m"),
        (dict(true_anomaly_deg=1.0), "true_anomaly_deg, mean_anomaly_deg"),
        (dict(frame="mars"), "frame"),
    ],
)
def test_arguments_of_conics_that_are_wrong(wrong, said):
    with pytest.raises(ValueError, match=said):
        elements(**wrong)


@pytest.mark.parametrize("wrong", [dict(eccentricity=1.5), dict(frame="itrf"), dict(last="2023-01-01T00:00:00Z")])
def test_conics_that_cannot_be(wrong):
    with pytest.raises(terrella.OrbitError):
        elements(**wrong)


@pytest.mark.parametrize(
    "wrong, said",
    [
        (dict(gravity_degree=21), "gravity_degree"),
        (dict(gravity_degree=4, gravity_order=5), "gravity_order"),
        (dict(air="mars"), "air"),
        (dict(relative_tolerance=0.0), "relative_tolerance"),
    ],
)
def test_arguments_of_integrations_that_are_wrong(wrong, said):
    with pytest.raises(ValueError, match=said):
        terrella.IntegratedOrbit(START, [7e6, 0, 0], [0, 7.5e3, 0], last=LAST, **wrong)
