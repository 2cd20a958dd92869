import { expect, test } from "vitest";

import { framed, moved } from "./corners";

test("corners begin inside the picture, clockwise from the left top", () => {
  expect(framed(640, 480)).toEqual([[76.8, 72], [563.2, 72], [563.2, 408], [76.8, 408]]);
});

test("a corner stays in the picture", () => {
  expect(moved([3, 4], -10, 1, { width: 640, height: 480 })).toEqual([0, 5]);
  expect(moved([630, 470], 20, 20, { width: 640, height: 480 })).toEqual([639, 479]);
});
