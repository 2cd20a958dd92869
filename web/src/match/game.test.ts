import { expect, it } from "vitest";

import type { Game } from "../api/types";
import { clock, perMinute, share } from "./game";

const game = (blue_s: number, yellow_s: number, collisions: number, played_s: number): Game => ({
  played_s,
  blue: { goals: 1, possession_s: blue_s },
  yellow: { goals: 0, possession_s: yellow_s },
  collisions,
  owner: null,
  driven: [],
});

it("shares the ball between the teams", () => {
  expect(share(game(30, 10, 0, 60))).toBe(75);
  expect(share(game(0, 0, 0, 60))).toBe(50);
});

it("counts collisions per minute", () => {
  expect(perMinute(game(0, 0, 6, 90))).toBe(4);
  expect(perMinute(game(0, 0, 0, 0))).toBe(0);
});

it("writes time as a clock", () => {
  expect(clock(187.9)).toBe("3:07");
});
