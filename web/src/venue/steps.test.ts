import { expect, test } from "vitest";

import type { NewVenue } from "../api/types";
import { blocked, missing, nextOf, ORDER } from "./steps";

const EMPTY = { pictures: [], field: null, camera: null, pattern: "", missing_colors: ["orange"], trial: null, is_saved: false } as unknown as NewVenue;
const with_ = (part: Partial<Record<keyof NewVenue, unknown>>) => ({ ...EMPTY, ...part }) as unknown as NewVenue;

test("a new draft begins with its pictures", () => {
  expect(nextOf(EMPTY)).toBe("pictures");
  expect(ORDER.every((step) => missing(step, EMPTY))).toBe(true);
  expect(blocked("pictures", EMPTY)).toBe("");
  expect(blocked("camera", EMPTY)).toBe("First: a picture of the field.");
});

test("the next step is the first that lacks something", () => {
  const venue = with_({ pictures: [{}], field: {}, camera: {}, pattern: "ssl-standard", missing_colors: ["pink"] });
  expect(nextOf(venue)).toBe("colors");
  expect(blocked("trial", venue)).toBe("First: samples of pink.");
  expect(nextOf({ ...venue, missing_colors: [] })).toBe("trial");
});
