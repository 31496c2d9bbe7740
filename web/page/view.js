// From a space to the screen and back: the plane, the globe and the Poincaré disk.
import { geoOrthographic, geoPath, geoGraticule10 } from "d3-geo";

const DEGREE = Math.PI / 180;

export const toUnit = ([longitude, latitude]) => {
  const c = Math.cos(latitude * DEGREE);
  return [c * Math.cos(longitude * DEGREE), c * Math.sin(longitude * DEGREE), Math.sin(latitude * DEGREE)];
};
export const toDegrees = (x, y, z) => [Math.atan2(y, x) / DEGREE, Math.atan2(z, Math.hypot(x, y)) / DEGREE];

/** The plane: scaled to show a box. */
export class PlaneView {
  constructor() {
    this.box = null;
    this.zoom = 1;
    this.shift = [0, 0];
  }
  fit(points) {
    let [a, b, c, d] = [Infinity, Infinity, -Infinity, -Infinity];
    for (const [x, y] of points) {
      a = Math.min(a, x);
      b = Math.min(b, y);
      c = Math.max(c, x);
      d = Math.max(d, y);
    }
    const pad = 0.12 * Math.max(c - a, d - b, 1e-9);
    this.box = Number.isFinite(a) ? [a - pad, b - pad, c + pad, d + pad] : [-1, -1, 1, 1];
    this.zoom = 1;
    this.shift = [0, 0];
  }
  resize(width, height) {
    const [a, b, c, d] = this.box;
    this.scale = this.zoom * Math.min(width / (c - a), height / (d - b));
    this.middle = [(a + c) / 2 + this.shift[0], (b + d) / 2 + this.shift[1]];
    this.size = [width, height];
  }
  screen([x, y]) {
    return [this.size[0] / 2 + (x - this.middle[0]) * this.scale, this.size[1] / 2 - (y - this.middle[1]) * this.scale, true];
  }
  space(x, y) {
    return [this.middle[0] + (x - this.size[0] / 2) / this.scale, this.middle[1] - (y - this.size[1] / 2) / this.scale];
  }
  pan(dx, dy) {
    this.shift = [this.shift[0] - dx / this.scale, this.shift[1] + dy / this.scale];
  }
  background() {}
  line(context, points, closed) {
    const n = points.length / 2;
    if (n === 0) return;
    const [w, t] = this.size;
    const [mx, my] = this.middle;
    const s = this.scale;
    context.beginPath();
    for (let i = 0; i < n; i++) {
      const x = w / 2 + (points[2 * i] - mx) * s;
      const y = t / 2 - (points[2 * i + 1] - my) * s;
      if (i === 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    }
    if (closed) context.closePath();
    context.stroke();
  }
  polygon(context, points, closed) {
    this.line(context, Float64Array.from(points.flat()), closed);
  }
  step() {
    return 3 / this.scale;
  }
}

/** The Poincaré disk in its unit circle. */
export class DiskView extends PlaneView {
  fit() {
    this.box = [-1.06, -1.06, 1.06, 1.06];
    this.zoom = 1;
    this.shift = [0, 0];
  }
  space(x, y) {
    const p = super.space(x, y);
    const r = Math.hypot(...p);
    return r < 0.995 ? p : [(p[0] * 0.995) / r, (p[1] * 0.995) / r];
  }
  background(context, color) {
    const [x, y] = this.screen([0, 0]);
    context.strokeStyle = color;
    context.lineWidth = 1.5;
    context.beginPath();
    context.arc(x, y, this.scale, 0, 2 * Math.PI);
    context.stroke();
  }
  polygon(context, points, closed) {
    const out = [];
    const n = points.length;
    for (let i = 0; i < (closed ? n : n - 1); i++) {
      const [p, q] = [points[i], points[(i + 1) % n]];
      // The geodesic from p: q moved to the origin's frame, a straight segment, and back.
      const divide = ([a, b], [c, d]) => {
        const m = c * c + d * d;
        return [(a * c + b * d) / m, (b * c - a * d) / m];
      };
      const w = divide([q[0] - p[0], q[1] - p[1]], [1 - (p[0] * q[0] + p[1] * q[1]), -(p[0] * q[1] - p[1] * q[0])]);
      const r = Math.min(Math.hypot(...w), 1 - 1e-12);
      const half = Math.atanh(r);
      for (let k = 0; k < 16; k++) {
        const s = r > 0 ? Math.tanh((half * k) / 16) / r : 0;
        const z = [w[0] * s, w[1] * s];
        out.push(divide([z[0] + p[0], z[1] + p[1]], [1 + (p[0] * z[0] + p[1] * z[1]), p[0] * z[1] - p[1] * z[0]]));
      }
    }
    if (!closed && n > 0) out.push(points[n - 1]);
    super.polygon(context, out, closed);
  }
}

/** The globe: points in degrees, lines of unit vectors. */
export class GlobeView {
  constructor() {
    this.projection = geoOrthographic().clipAngle(90).precision(0.4);
    this.zoom = 1;
  }
  fit(points) {
    let sum = [0, 0, 0];
    for (const p of points) sum = toUnit(p).map((value, i) => value + sum[i]);
    const [longitude, latitude] = toDegrees(...sum);
    let widest = 0;
    const middle = toUnit([longitude, latitude]);
    for (const p of points) {
      const u = toUnit(p);
      widest = Math.max(widest, Math.acos(Math.max(-1, Math.min(1, u[0] * middle[0] + u[1] * middle[1] + u[2] * middle[2]))));
    }
    this.projection.rotate([-longitude, -Math.max(-55, Math.min(55, latitude))]);
    this.zoom = widest < 1 ? Math.min(60, 0.85 / Math.max(Math.sin(widest), 0.01)) : 1;
    if (widest < 1) this.projection.rotate([-longitude, -latitude]);
  }
  resize(width, height) {
    this.size = [width, height];
    this.projection.translate([width / 2, height / 2]).scale(this.zoom * 0.47 * Math.min(width, height));
  }
  screen(p) {
    const [l, f] = this.projection.rotate();
    const [a, b] = [toUnit(p), toUnit([-l, -f])];
    const [x, y] = this.projection(p) ?? [-99, -99];
    return [x, y, a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0];
  }
  space(x, y) {
    const p = this.projection.invert([x, y]);
    return p && p.every(Number.isFinite) ? p : null;
  }
  pan(dx, dy) {
    const [l, f] = this.projection.rotate();
    const k = 57 / this.projection.scale();
    this.projection.rotate([l + dx * k, Math.max(-90, Math.min(90, f - dy * k))]);
  }
  background(context, color) {
    const path = geoPath(this.projection, context);
    context.strokeStyle = color;
    context.lineWidth = 1;
    context.beginPath();
    path(geoGraticule10());
    context.stroke();
    context.beginPath();
    path({ type: "Sphere" });
    context.stroke();
  }
  line(context, points, closed) {
    const coordinates = [];
    for (let i = 0; i < points.length; i += 3) coordinates.push(toDegrees(points[i], points[i + 1], points[i + 2]));
    this.polygon(context, coordinates, closed);
  }
  polygon(context, points, closed) {
    if (points.length === 0) return;
    context.beginPath();
    geoPath(this.projection, context)({ type: "LineString", coordinates: closed ? [...points, points[0]] : points });
    context.stroke();
  }
  step() {
    return (3 / this.projection.scale()) * 57;
  }
}

export const VIEWS = { plane: PlaneView, sphere: GlobeView, disk: DiskView };
