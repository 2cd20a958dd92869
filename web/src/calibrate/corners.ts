// The four corners of the field that somebody drags, in the order of the API.

export type Corner = [number, number];

export const CORNERS = ["left top", "right top", "right bottom", "left bottom"] as const;

/** Where they stand before anybody has dragged them: a frame inside the picture. */
export function framed(width: number, height: number): Corner[] {
  const [left, right, top, bottom] = [0.12 * width, 0.88 * width, 0.15 * height, 0.85 * height];
  return [[left, top], [right, top], [right, bottom], [left, bottom]];
}

/** A corner after a step; it stays in the picture. */
export function moved([x, y]: Corner, dx: number, dy: number, { width, height }: { width: number; height: number }): Corner {
  const within = (value: number, size: number) => Math.min(Math.max(value, 0), size - 1);
  return [within(x + dx, width), within(y + dy, height)];
}
