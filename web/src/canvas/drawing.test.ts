import { describe, expect, it, vi } from "vitest";

vi.stubGlobal("matchMedia", () => ({ matches: false, addEventListener: () => undefined }));
const { freeBox, runsOf } = await import("./drawing");

describe("runsOf", () => {
  it("joins the end of the circle with its beginning", () => {
    expect(runsOf([1, 1, 2, 2, 2, 1])).toEqual([
      { code: 2, start: 2, length: 3 },
      { code: 1, start: 5, length: 3 },
    ]);
  });
  it("is one run where all is equal", () => {
    expect(runsOf([7, 7, 7])).toEqual([{ code: 7, start: 0, length: 3 }]);
  });
  it("covers every direction once", () => {
    const codes = Array.from({ length: 360 }, (_, at) => (at * at) % 5);
    expect(runsOf(codes).reduce((sum, { length }) => sum + length, 0)).toBe(360);
  });
});

describe("freeBox", () => {
  it("takes the first place that covers nothing", () => {
    const taken: [number, number, number, number][] = [[0, 0, 10, 10]];
    expect(freeBox(taken, [[5, 5, 10, 10], [10, 0, 5, 5]])).toEqual([10, 0, 5, 5]);
    expect(taken).toHaveLength(2);
    expect(freeBox(taken, [[11, 1, 1, 1]])).toBeUndefined();
  });
});
