// The pairs of the table: cells as they are typed, read as numbers, and the row that a message is about.

import type { FoundPair } from "../api/types";

export interface Row {
  r_mm: string;
  r_px: string;
}

export interface Pair {
  r_mm: number;
  r_px: number;
  name: string;
}

export const emptyRows = (count: number): Row[] => Array.from({ length: count }, () => ({ r_mm: "", r_px: "" }));
export const isEmpty = (row: Row) => !row.r_mm.trim() && !row.r_px.trim();

/** A number as people type it, also with a decimal comma; NaN: none. */
export function numberOf(text: string): number {
  return text.trim() ? Number(text.trim().replace(",", ".")) : NaN;
}

/** The pairs of the rows that are not empty, and what is wrong with a row, by its place from 0. */
export function pairsOf(rows: readonly Row[]): { pairs: Pair[]; errors: Record<number, string> } {
  const pairs: Pair[] = [];
  const errors: Record<number, string> = {};
  rows.forEach((row, index) => {
    if (isEmpty(row)) return;
    const [r_mm, r_px] = [numberOf(row.r_mm), numberOf(row.r_px)];
    if (r_mm > 0 && r_px > 0) pairs.push({ r_mm, r_px, name: `row ${index + 1}` });
    else errors[index] = `${r_mm > 0 ? `R is “${row.r_px}”` : `r is “${row.r_mm}”`}; accepted: a number above 0, as 61 or 373.5`;
  });
  return { pairs, errors };
}

/** The place of the row that a message names, "row 12"; -1: none. */
export const rowOf = (asked: string | undefined) => Number(/\brow (\d+)/.exec(asked ?? "")?.[1] ?? 0) - 1;

/** Does a text that is pasted into a cell hold more than that cell? */
export const isBlock = (text: string) => /[\t;\n]|\d\s*,\s+\d/.test(text.trim());

/** The rows with those of a pasted text in place of what is empty at their end. */
export function withPasted(rows: readonly Row[], pasted: { pairs: readonly { r_mm: number; r_px: number }[] }): Row[] {
  const kept = rows.filter((row) => !isEmpty(row));
  return [...kept, ...pasted.pairs.map(({ r_mm, r_px }) => ({ r_mm: String(r_mm), r_px: String(r_px) })), ...emptyRows(1)];
}

/** The pairs that a picture shows around a robot. */
export interface PictureGroup {
  picture: number;
  name: string;
  /** The robot, or the file that says what stood around it. */
  whose: string;
  pairs: readonly FoundPair[];
}

/** The groups with another one, which replaces that of the same picture. */
export const withGroup = (groups: readonly PictureGroup[], added: PictureGroup): PictureGroup[] => [...groups.filter((one) => one.picture !== added.picture), added];

/** The pairs of groups as a fit asks for them. */
export const pairsOfGroups = (groups: readonly PictureGroup[]) => groups.flatMap((group) => group.pairs.map(({ place_px: _, ...pair }) => pair));

/** "312 pairs, 75 to 1700 mm". */
export function spanOf({ pairs }: PictureGroup): string {
  const distances = pairs.map((pair) => pair.r_mm);
  return `${pairs.length} pairs, ${Math.min(...distances).toFixed(0)} to ${Math.max(...distances).toFixed(0)} mm`;
}
