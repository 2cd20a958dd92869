import { expect, test } from "vitest";

import { changeWords, shift, state } from "./adaptation";

const light = { gain_bgr: [1.5, 1, 0.8], set_up_gain_bgr: [1, 1, 1], black_bgr: [0, 0, 0], max_gain: 16, is_measured: true, reason: "" } as const;
const paint = { name: "blue", set_up: [0.5, -0.2], now: [0.9, -0.9], patches: 3 } as const;
const now = { held: false, as_set_up: false, light: { ...light, gain_bgr: [...light.gain_bgr], set_up_gain_bgr: [...light.set_up_gain_bgr], black_bgr: [...light.black_bgr] }, paints: [], max_shift: 1.5, changes: [] } as Parameters<typeof state>[0];

test("what is in force is said", () => {
  expect(state(now)).toBe("Adapted to another light: other gains.");
  expect(state({ ...now, paints: [{ ...paint, set_up: [0.5, -0.2], now: [0.9, -0.9] }] })).toContain("and a palette that was learned");
  expect(state({ ...now, as_set_up: true })).toBe("As set up.");
  expect(state({ ...now, held: true, as_set_up: true })).toContain("Held");
});

test("changes say what was read", () => {
  const change = { age_s: 3, what: "learned", gain_bgr: [1, 1, 1] as [number, number, number], robots: 6, read: 5 };
  expect(changeWords(change)).toBe("palette learned from the robots that were read: 5 of 6 robots read");
  expect(changeWords({ ...change, what: "light", gain_bgr: [2, 1, 0.5] })).toBe("light: gains 2.00, 1.00, 0.50");
});

test("a paint's shift is that of the coordinate that moved more", () => {
  expect(shift({ ...paint, set_up: [0.5, -0.2], now: [0.9, -0.9] })).toBeCloseTo(0.7);
});
