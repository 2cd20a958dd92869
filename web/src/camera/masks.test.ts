import { describe, expect, it } from "vitest";

import { maskEditor, pointsIn, pointsText } from "./masks";

const editor = () => {
  const made = maskEditor(() => ({ width: 640, height: 480 }));
  made.load([{ name: "mask 2", points_px: [[0, 0], [10, 0], [0, 10]] }]);
  return made;
};

describe("masks", () => {
  it("are drawn point by point, inside the picture, and closed", () => {
    const { state, begin, add, close, isDirty } = editor();
    begin();
    add([100, 100]);
    add([900, 100.04]);
    expect(close()).toBe(false);
    add([200, -5]);
    expect(close()).toBe(true);
    expect(state.masks[1]).toEqual({ name: "mask 3", points_px: [[100, 100], [640, 100], [200, 0]] });
    expect([state.chosen, isDirty.value]).toEqual([1, true]);
  });

  it("are not changed by a drawing that is canceled", () => {
    const { state, begin, add, cancel, isDirty } = editor();
    begin();
    add([1, 1]);
    cancel();
    expect([state.draft, state.masks.length, isDirty.value]).toEqual([null, 1, false]);
  });

  it("have points that are moved and removed, but three stay", () => {
    const { state, choose, take, move, removePoint } = editor();
    choose(0);
    expect(take(300, 300, 8)).toBe(false);
    expect(take(9, 1, 8)).toBe(true);
    move([50, 60]);
    expect(state.masks[0]!.points_px[1]).toEqual([50, 60]);
    removePoint();
    expect(state.masks[0]!.points_px).toHaveLength(3);
  });

  it("can be written as text", () => {
    expect(pointsIn(pointsText([[0, 0], [10.5, 0], [0, 10]]))).toEqual([[0, 0], [10.5, 0], [0, 10]]);
    expect(pointsIn("1, 2\n3\n4, 5")).toBe("line 2: 3; accepted: two numbers, as 120, 45");
    expect(pointsIn("1, 2")).toBe("1 points; accepted: 3 to 32");
  });
});
