import { expect, test } from "vitest";

import { firstBeginning } from "./beginning";

type Known = Parameters<typeof firstBeginning>[0];
const known = (field: object, accepted: boolean | null): Known =>
  ({ preset: "a", field: { walls: true, margin_m: 0, line_width_m: 0.003, ...field }, fields: accepted === null ? null : [{ preset: "a", is_accepted: accepted }] }) as unknown as Known;

test("corners alone come first where no touch lines are painted", () => {
  expect(firstBeginning(known({}, null))).toBe("walls");
  expect(firstBeginning(known({}, false))).toBe("walls");
  expect(firstBeginning(known({ line_width_m: 0 }, null))).toBe("walls");
});

test("lines that were recognized are searched, and corners are dragged where none were", () => {
  expect(firstBeginning(known({}, true))).toBe("find");
  expect(firstBeginning(known({ line_width_m: 0.01 }, null))).toBe("find");
  expect(firstBeginning(known({ walls: false }, null))).toBe("find");
  expect(firstBeginning(known({ line_width_m: 0.01 }, false))).toBe("corners");
});
