// Equation 1 of the paper, a hyperboloidal mirror over a pinhole camera:  r = f(R) = R / (A - B sqrt(C + R^2)),
// r [mm] on the floor, R [px] from the image's center. The server has the same in vision_core/models/mirror.py.

export interface Constants {
  a: number;
  b: number;
  c: number;
}

/** Focal length f [px], height h of the effective viewpoint [mm], bend u: one-to-one with A, B, C. */
export interface Shape {
  focal_px: number;
  height_mm: number;
  bend: number;
}

export const NOTHING_PX = 255; // a direction in which nothing is seen
const MAX_PX = 254;

const dOf = ({ a, b, c }: Constants): number => a * a - b * b * c;

/** R of r, for every r >= 0: without branches, and with all digits near the horizon. */
export function pxFromMm(r_mm: number, mirror: Constants): number {
  const d = dOf(mirror);
  return (d * r_mm) / (mirror.a + mirror.b * Math.sqrt(mirror.c + d * r_mm * r_mm));
}

/** r of R; Infinity from the horizon on. */
export function mmFromPx(r_px: number, { a, b, c }: Constants): number {
  const slope = a - b * Math.sqrt(c + r_px * r_px);
  return slope > 0 ? r_px / slope : Infinity;
}

/** C > 0, B > 0 and A > B sqrt(C): there is a curve to draw. The server judges the rest. */
export function isMirror({ a, b, c }: Constants): boolean {
  return [a, b, c].every(Number.isFinite) && c > 0 && b > 0 && a > b * Math.sqrt(c);
}

export function horizonPx({ a, b, c }: Constants): number {
  return Math.sqrt(Math.max((a / b) ** 2 - c, 0));
}

export function shapeOf(mirror: Constants): Shape {
  const focal_px = Math.sqrt(mirror.c);
  const height_mm = focal_px / Math.sqrt(dOf(mirror));
  return { focal_px, height_mm, bend: Math.asinh(mirror.b * height_mm) };
}

/** Distance on the floor at 0, 1, 2, ... pixels [m]; null beyond the horizon: as `mirror_m` of the field. */
export function tableOf(mirror: Constants): (number | null)[] {
  return Array.from({ length: MAX_PX + 1 }, (_, px) => {
    const mm = mmFromPx(px, mirror);
    return Number.isFinite(mm) ? mm / 1000 : null;
  });
}

/** A radius of a view through one mirror, as another would show it: from the middle of its pixel, cut to a whole one. */
export function throughOther(px: number, from: Constants, to: Constants): number {
  return Math.min(Math.floor(pxFromMm(Math.min(mmFromPx(px + 0.5, from), 1e9), to)), MAX_PX);
}

/** A whole view through another mirror; directions in which nothing is seen stay so. */
export function viewThrough(px: Uint8Array, from: Constants, to: Constants): Uint8Array {
  return px.map((radius) => (radius === NOTHING_PX ? NOTHING_PX : throughOther(radius, from, to)));
}
