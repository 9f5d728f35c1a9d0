// Places on WGS84 as ITRF coordinates, metres.

/** Equatorial and polar radius. */
export const EQUATOR_M = 6_378_137;
export const POLE_M = 6_356_752.314245;
/** The rotation of the Earth, radians per second. */
export const ROTATION_RAD_S = 7.292115e-5;

/** A place: degrees, and metres above the ellipsoid. */
export function itrf(lat, lon, height) {
  const [phi, lambda] = [(lat * Math.PI) / 180, (lon * Math.PI) / 180];
  const squash = (POLE_M / EQUATOR_M) ** 2;
  const normal = EQUATOR_M / Math.sqrt(Math.cos(phi) ** 2 + squash * Math.sin(phi) ** 2);
  const across = (normal + height) * Math.cos(phi);
  return [across * Math.cos(lambda), across * Math.sin(lambda), (squash * normal + height) * Math.sin(phi)];
}

/** A point of a circular orbit: radius, inclination, longitude of the ascending node at the instant, and the angle from the node. */
export function onCircle(radius, inclination, node, along) {
  const [x, y, z] = [Math.cos(along), Math.sin(along) * Math.cos(inclination), Math.sin(along) * Math.sin(inclination)];
  return [radius * (x * Math.cos(node) - y * Math.sin(node)), radius * (x * Math.sin(node) + y * Math.cos(node)), radius * z];
}
