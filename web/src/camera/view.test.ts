import { describe, expect, it } from "vitest";

import { clamped, fitted, MAX_ZOOM, panned, pixelAt, zoomed } from "./view";

const canvas = { width: 320, height: 300 };
const picture = { width: 640, height: 480 };

describe("the view of a picture", () => {
  it("fits the picture into the middle", () => {
    expect(fitted(canvas, picture)).toEqual({ zoom: 1, x: 0, y: 30 });
  });

  it("keeps the pixel under the pointer when it zooms", () => {
    const before = zoomed(fitted(canvas, picture), 4, 160, 150, canvas, picture);
    const there = pixelAt(before, 100, 90, canvas, picture);
    const after = zoomed(before, 1.25, 100, 90, canvas, picture);
    const [x, y] = pixelAt(after, 100, 90, canvas, picture);
    expect(x).toBeCloseTo(there[0]);
    expect(y).toBeCloseTo(there[1]);
  });

  it("does not leave the picture", () => {
    const near = zoomed(fitted(canvas, picture), 2, 0, 0, canvas, picture);
    expect(panned(near, 9999, 9999, canvas, picture)).toEqual({ zoom: 2, x: 0, y: 0 });
    expect(panned(near, -9999, -9999, canvas, picture)).toEqual({ zoom: 2, x: -320, y: -180 });
  });

  it("has limits", () => {
    expect(zoomed(fitted(canvas, picture), 1000, 0, 0, canvas, picture).zoom).toBe(MAX_ZOOM);
    expect(clamped({ zoom: 0.1, x: 5, y: 5 }, canvas, picture)).toEqual(fitted(canvas, picture));
  });
});
