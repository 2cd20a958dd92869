import { describe, expect, it } from "vitest";

import { emptyRows, isBlock, pairsOf, pairsOfGroups, rowOf, spanOf, withGroup, withPasted, type PictureGroup } from "./rows";

describe("pairs of the table", () => {
  it("reads decimal commas, skips empty rows and keeps their numbers", () => {
    const rows = [{ r_mm: "110", r_px: "25,5" }, ...emptyRows(1), { r_mm: " 220 ", r_px: "44" }];
    expect(pairsOf(rows)).toEqual({ pairs: [{ r_mm: 110, r_px: 25.5, name: "row 1" }, { r_mm: 220, r_px: 44, name: "row 3" }], errors: {} });
  });
  it("says what is wrong in which row", () => {
    const { pairs, errors } = pairsOf([{ r_mm: "x", r_px: "25" }, { r_mm: "110", r_px: "" }, { r_mm: "110", r_px: "-3" }]);
    expect(pairs).toEqual([]);
    expect(Object.values(errors).map((words) => words.split(";")[0])).toEqual(["r is “x”", "R is “”", "R is “-3”"]);
  });
  it("finds the row of a message", () => {
    expect([rowOf("row 12"), rowOf("the text, line 3"), rowOf(undefined)]).toEqual([11, -1, -1]);
  });
  it("knows a block from a number", () => {
    expect(["25\t110", "25;110", "25\n26", "25, 110"].map(isBlock)).toEqual([true, true, true, true]);
    expect(["25", "25,5", " 25.5 \n"].map(isBlock)).toEqual([false, false, false]);
  });
  it("puts pasted rows behind those that are there", () => {
    const pasted = { pairs: [{ r_px: 44, r_mm: 220, name: "line 1" }] };
    expect(withPasted([{ r_mm: "110", r_px: "25" }, ...emptyRows(3)], pasted).map((row) => row.r_mm)).toEqual(["110", "220", ""]);
  });
  it("has the pairs of a picture once, and asks for them without their places", () => {
    const pair = { name: "a.png at 3 degrees", r_px: 60, r_mm: 370.4, shared_mm: 0.5, shared_px: 0.1, place_px: [1, 2] as [number, number] };
    const group: PictureGroup = { picture: 7, name: "a.png", whose: "blue 3", pairs: [pair, { ...pair, r_mm: 110 }] };
    const groups = withGroup(withGroup([], { ...group, pairs: [] }), group);
    expect(groups).toEqual([group]);
    expect(spanOf(group)).toBe("2 pairs, 110 to 370 mm");
    expect(pairsOfGroups(groups)[0]).toEqual({ name: "a.png at 3 degrees", r_px: 60, r_mm: 370.4, shared_mm: 0.5, shared_px: 0.1 });
  });
});
