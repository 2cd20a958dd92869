import { expect, it } from "vitest";

import { age, counted, milliseconds, shortUri, valueText } from "./words";

it("says ages so that they can be read at a glance", () => {
  expect([0.0123, 0.9, 3.44, 250, 7300].map(age)).toEqual(["12 ms", "900 ms", "3.4 s", "4 min", "2 h 1 min"]);
  expect(age(null)).toBe("–");
});

it("shows milliseconds with two significant digits", () => {
  expect([0.0312, 1.04, 12.4, null].map(milliseconds)).toEqual(["0.03", "1.0", "12", "–"]);
});

it("counts things", () => {
  expect([counted(1, "robot"), counted(0, "robot")]).toEqual(["1 robot", "0 robots"]);
});

it("names a file by its last part", () => {
  expect(["file:/home/hall/pictures/", "camera:0"].map(shortUri)).toEqual(["pictures", "camera:0"]);
});

it("shows a setting's value", () => {
  expect([valueText("left"), valueText([1, 2]), valueText(null)]).toEqual(["left", "[1,2]", "–"]);
});
