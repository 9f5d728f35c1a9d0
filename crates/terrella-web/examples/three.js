// three.js above the Earth: a satellite, its orbit and a mark on the ground, with one camera for both.
//
// The libraries have a canvas each and share no depth: a globe that three.js draws into its depth alone hides what is behind the Earth.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import "terrella";
import { EQUATOR_M, POLE_M, ROTATION_RAD_S, itrf, onCircle } from "./geodesy.js";

/** A place whose mark is on the same pixel in both pictures: Punta de Tarifa. */
export const MARK = { lat: 36.0003, lon: -5.6103 };
const MARK_PX = 9;
/** The instant of the orbit's node. */
const FIRST = Date.parse("2026-06-21T11:00:00Z");
/** Orbit: radius, inclination, and longitude of the node at that instant. */
const RADIUS_M = 7_400_000;
const INCLINATION = 0.9;
const NODE = -1;
/** Earth's gravity, m³/s². */
const MU = 3.986004418e14;
/** Size of the satellite's body, metres. */
const BODY_M = 60_000;

const element = document.querySelector("terrella-earth");
const renderer = new THREE.WebGLRenderer({ canvas: document.querySelector("#over"), alpha: true, antialias: true, logarithmicDepthBuffer: true });

/** The camera in ITRF, metres, which the controls move. JavaScript's numbers keep it to the nanometre. */
export const camera = new THREE.PerspectiveCamera(40, 1, 10, 1e9);
camera.up.set(0, 0, 1);
camera.position.set(...itrf(25, -15, 9_000_000));
export const controls = new OrbitControls(camera, renderer.domElement);
controls.minDistance = EQUATOR_M + 300_000;
controls.maxDistance = 100_000_000;

/** The camera that three.js draws with stays in the origin: graphics cards have numbers of 24 bits, half a metre at the Earth's radius. */
const eye = camera.clone();
eye.position.set(0, 0, 0);
const scene = new THREE.Scene();
scene.add(new THREE.HemisphereLight(0xffffff, 0x334466, 3));

/** Moves an object to a place relative to the eye. */
const put = (object, place) => object.position.set(...["x", "y", "z"].map((axis, i) => place[i] - camera.position[axis]));

const globe = new THREE.Mesh(new THREE.SphereGeometry(1, 512, 256), new THREE.MeshBasicMaterial({ colorWrite: false }));
// The sphere's poles are on its y axis.
globe.rotation.x = Math.PI / 2;
globe.scale.set(EQUATOR_M, POLE_M, EQUATOR_M);
globe.renderOrder = -1;

const mark = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({ color: 0xff00ff, size: MARK_PX, sizeAttenuation: false }));
mark.geometry.setAttribute("position", new THREE.Float32BufferAttribute([0, 0, 0], 3));
// A mark on the ground would be half below the flat triangles of the globe.
mark.material.depthTest = false;
const markItrf = itrf(MARK.lat, MARK.lon, 0);

const satellite = new THREE.Group();
const body = new THREE.Mesh(new THREE.BoxGeometry(BODY_M, BODY_M, 2 * BODY_M), new THREE.MeshStandardMaterial({ color: 0xd8c070 }));
const panels = new THREE.Mesh(new THREE.BoxGeometry(6 * BODY_M, BODY_M / 20, BODY_M), new THREE.MeshStandardMaterial({ color: 0x3050c0 }));
satellite.add(body, panels);

const ORBIT_POINTS = 512;
const orbit = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0xffe080 }));
orbit.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * ORBIT_POINTS), 3));
orbit.frustumCulled = false;
scene.add(globe, mark, satellite, orbit);

/** Places everything of an instant relative to the eye. */
function place(seconds) {
  const node = NODE - ROTATION_RAD_S * seconds;
  const point = (along) => onCircle(RADIUS_M, INCLINATION, node, along);
  const positions = orbit.geometry.attributes.position;
  const { x, y, z } = camera.position;
  for (let i = 0; i < ORBIT_POINTS; i++) {
    const at = point((2 * Math.PI * i) / (ORBIT_POINTS - 1));
    positions.setXYZ(i, at[0] - x, at[1] - y, at[2] - z);
  }
  positions.needsUpdate = true;
  put(satellite, point(seconds * Math.sqrt(MU / RADIUS_M ** 3)));
  put(globe, [0, 0, 0]);
  put(mark, markItrf);
  // A mark that the Earth hides is not drawn.
  const up = new THREE.Vector3(...markItrf);
  mark.visible = camera.position.clone().sub(up).dot(up) > 0;
}

/** Draws both pictures. */
export function draw() {
  const { earth } = element;
  if (!earth) return;
  eye.fov = camera.fov;
  eye.quaternion.copy(camera.quaternion);
  eye.updateProjectionMatrix();
  place((earth.epoch - FIRST) / 1000);
  const direction = camera.getWorldDirection(new THREE.Vector3());
  const up = new THREE.Vector3(0, 1, 0).applyQuaternion(camera.quaternion);
  earth.setCamera({ position: camera.position.toArray(), direction: direction.toArray(), up: up.toArray(), fov: camera.fov });
  // In the same task, so that the browser shows both pictures together.
  earth.draw();
  renderer.render(scene, eye);
}

new ResizeObserver(() => {
  const { clientWidth: width, clientHeight: height } = element;
  renderer.setPixelRatio(devicePixelRatio);
  renderer.setSize(width, height, false);
  eye.aspect = width / height;
}).observe(element);

// Clicks belong to the upper canvas; the Earth answers with the event `pick`.
renderer.domElement.addEventListener("click", (event) => element.earth?.click(event.offsetX * devicePixelRatio, event.offsetY * devicePixelRatio));
element.addEventListener("pick", ({ detail: { place } }) => console.log(place ? `${place.lat.toFixed(3)}°, ${place.lon.toFixed(3)}°` : "beside the globe"));

renderer.setAnimationLoop(() => {
  controls.update();
  draw();
});
