// CesiumJS above the Earth: entities and the camera are its own, the globe below them is Terrella's.
//
// The libraries have a canvas each and share no depth: an ellipsoid that CesiumJS draws into its depth alone hides what is behind the Earth.

import "terrella";
import { ROTATION_RAD_S, onCircle } from "./geodesy.js";

const { Cesium } = window;

/** A place whose mark is on the same pixel in both pictures: Punta de Tarifa. */
export const MARK = { lat: 36.0003, lon: -5.6103 };
const MARK_PX = 9;
const FIRST = "2026-06-21T11:00:00Z";
/** Orbit: radius, inclination, longitude of the node at the first instant, and the period. */
const RADIUS_M = 7_400_000;
const INCLINATION = 0.9;
const NODE = -1;
const PERIOD_S = 6335;
const STEP_S = 60;
const element = document.querySelector("terrella-earth");
export const widget = new Cesium.CesiumWidget("over", {
  baseLayer: false,
  skyBox: false,
  skyAtmosphere: false,
  contextOptions: { webgl: { alpha: true } },
  // It would draw over an opaque background.
  orderIndependentTranslucency: false,
  useBrowserRecommendedResolution: false,
  creditContainer: document.createElement("div"),
});
const { scene, camera, clock, entities } = widget;
scene.globe.show = false;
scene.backgroundColor = Cesium.Color.TRANSPARENT;
clock.currentTime = Cesium.JulianDate.fromIso8601(FIRST);

const ellipsoid = new Cesium.EllipsoidGeometry({
  radii: Cesium.Ellipsoid.WGS84.radii,
  stackPartitions: 256,
  slicePartitions: 512,
  vertexFormat: Cesium.VertexFormat.POSITION_ONLY,
});
scene.primitives.add(
  new Cesium.Primitive({
    geometryInstances: new Cesium.GeometryInstance({
      geometry: ellipsoid,
      attributes: { color: Cesium.ColorGeometryInstanceAttribute.fromColor(Cesium.Color.BLACK) },
    }),
    appearance: new Cesium.PerInstanceColorAppearance({
      flat: true,
      translucent: false,
      renderState: { depthTest: { enabled: true }, colorMask: { red: false, green: false, blue: false, alpha: false } },
    }),
    allowPicking: false,
    asynchronous: false,
  }),
);

const place = Cesium.Cartesian3.fromDegrees(MARK.lon, MARK.lat);
// The slanting ground would hide half of a point that faces the eye.
const point = { pixelSize: MARK_PX, color: Cesium.Color.MAGENTA, disableDepthTestDistance: Number.POSITIVE_INFINITY };
const mark = entities.add({ position: place, point });

// The path of a satellite over the turning Earth, and where it is now.
const first = clock.currentTime.clone();
const path = new Cesium.SampledPositionProperty();
path.setInterpolationOptions({ interpolationAlgorithm: Cesium.LagrangePolynomialApproximation, interpolationDegree: 5 });
for (let s = -PERIOD_S; s <= 15 * PERIOD_S; s += STEP_S) {
  const point = onCircle(RADIUS_M, INCLINATION, NODE - ROTATION_RAD_S * s, (2 * Math.PI * s) / PERIOD_S);
  path.addSample(Cesium.JulianDate.addSeconds(first, s, new Cesium.JulianDate()), Cesium.Cartesian3.fromArray(point));
}
entities.add({
  position: path,
  point: { pixelSize: 11, color: Cesium.Color.GOLD },
  path: { leadTime: PERIOD_S / 2, trailTime: PERIOD_S / 2, width: 2, material: Cesium.Color.GOLD, resolution: STEP_S },
});
camera.setView({ destination: Cesium.Cartesian3.fromDegrees(-15, 25, 9_000_000) });

scene.preUpdate.addEventListener(() => {
  mark.show = new Cesium.EllipsoidalOccluder(Cesium.Ellipsoid.WGS84, camera.positionWC).isPointVisible(place);
});

// Before each picture of CesiumJS, in the same task, so that the browser shows both together.
scene.preRender.addEventListener((_, time) => {
  const { earth } = element;
  if (!earth) return;
  const axis = ({ x, y, z }) => [x, y, z];
  earth.epoch = Cesium.JulianDate.toDate(time);
  earth.setCamera({
    position: axis(camera.positionWC),
    direction: axis(camera.directionWC),
    up: axis(camera.upWC),
    fov: Cesium.Math.toDegrees(camera.frustum.fovy),
  });
  earth.draw();
});

// Clicks belong to the upper canvas; the Earth answers with the event `pick`.
new Cesium.ScreenSpaceEventHandler(widget.canvas).setInputAction(({ position }) => {
  element.earth?.click(position.x * devicePixelRatio, position.y * devicePixelRatio);
}, Cesium.ScreenSpaceEventType.LEFT_CLICK);
element.addEventListener("pick", ({ detail: { place } }) => console.log(place ? `${place.lat.toFixed(3)}°, ${place.lon.toFixed(3)}°` : "beside the globe"));
