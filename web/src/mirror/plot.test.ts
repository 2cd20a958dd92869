import { describe, expect, it } from "vitest";

import { lineOf, reachOfResiduals, scaleOf, ticksOf } from "./plot";

const pair = (off_px: number | null, counts = true) => ({ name: "", r_px: 1, r_mm: 1, off_px, counts });

describe("the mirror's plot", () => {
  it("has round ticks within its ends", () => {
    expect(ticksOf(0, 2500, 6)).toEqual([0, 500, 1000, 1500, 2000, 2500]);
    expect(ticksOf(-1.3, 1.3, 4)).toEqual([-1, 0, 1]);
  });
  it("puts its ends at the ends", () => {
    const { of } = scaleOf(0, 200, 260, 10, 5);
    expect([of(0), of(200), of(100)]).toEqual([260, 10, 135]);
  });
  it("draws a line through points", () => {
    expect(lineOf([[0, 1], [2, 3.04]])).toBe("M0.0 1.0L2.0 3.0");
  });
  it("makes room for pairs that count, not for those left out", () => {
    expect(reachOfResiduals([pair(-2), pair(40, false), pair(null)])).toBeCloseTo(2.3);
    expect(reachOfResiduals([])).toBe(1);
  });
});
