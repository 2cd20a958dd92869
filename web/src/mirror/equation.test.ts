import { describe, expect, it } from "vitest";

import { horizonPx, isMirror, mmFromPx, pxFromMm, shapeOf, tableOf, throughOther, viewThrough } from "./equation";

const PAPER = { a: 4.0187, b: 0.0125935, c: 90000 };
const OTHER = { a: 5.2, b: 0.0165, c: 90000 };
const TABLE = [[110, 0x19], [150, 0x20], [220, 0x2c], [300, 0x35], [380, 0x3d], [500, 0x45], [700, 0x4e], [1000, 0x56], [1500, 0x5d], [2000, 0x60], [2750, 0x63]] as const;

describe("equation 1", () => {
  it.each(TABLE)("sees %i mm where the worked example does", (mm, px) => {
    expect(Math.floor(pxFromMm(mm, PAPER) + 1e-2)).toBe(px);
  });
  it("is the inverse of its inverse, up to the horizon", () => {
    for (let px = 0; px < 108; px += 3.7) expect(pxFromMm(mmFromPx(px, PAPER), PAPER)).toBeCloseTo(px, 9);
    expect(horizonPx(PAPER)).toBeCloseTo(108.8, 1);
    expect(mmFromPx(horizonPx(PAPER) + 1e-6, PAPER)).toBe(Infinity);
    expect(pxFromMm(1e12, PAPER)).toBeCloseTo(horizonPx(PAPER), 3);
  });
  it("has the shape that the paper's numbers imply", () => {
    const { focal_px, height_mm, bend } = shapeOf(PAPER);
    expect([focal_px, height_mm, bend].map((value) => Number(value.toPrecision(4)))).toEqual([300, 219, 1.739]);
    expect((focal_px * Math.cosh(bend)) / height_mm).toBeCloseTo(PAPER.a, 9);
    expect(Math.sinh(bend) / height_mm).toBeCloseTo(PAPER.b, 9);
  });
  it("knows what is no mirror", () => {
    expect(isMirror(PAPER)).toBe(true);
    const wrong = [{ ...PAPER, a: 3 }, { ...PAPER, b: 0 }, { ...PAPER, c: -1 }, { ...PAPER, c: NaN }];
    expect(wrong.map(isMirror)).toEqual([false, false, false, false]);
  });
  it("tabulates metres, null beyond the horizon", () => {
    const table = tableOf(PAPER);
    expect(table).toHaveLength(255);
    expect(table[44]).toBeCloseTo(0.22, 2);
    expect([table[108] === null, table[109] === null]).toEqual([false, true]);
  });
});

describe("a view through another mirror", () => {
  it("is the same through the same mirror", () => {
    const px = Uint8Array.from([0, 1, 25, 44, 86, 100, 107, 255]);
    expect(viewThrough(px, PAPER, PAPER)).toEqual(px);
  });
  it("keeps what is seen at its distance, to the pixel", () => {
    for (const mm of [120, 300, 700, 1500]) {
      const moved = throughOther(Math.floor(pxFromMm(mm, PAPER)), PAPER, OTHER);
      expect(Math.abs(moved - Math.floor(pxFromMm(mm, OTHER)))).toBeLessThanOrEqual(1);
    }
  });
  it("shows the pixel at the horizon just inside the other horizon", () => {
    expect(throughOther(108, PAPER, OTHER)).toBe(Math.floor(horizonPx(OTHER)));
  });
});
