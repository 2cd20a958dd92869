// Shared by everything that draws: sharp canvases, the colors of the theme, names of robots, runs of edges.

import type { Color, Field } from "../api/types";

const UNDEFINED_COLOR = "#ff00ff"; // of a code that the server's table lacks: loud, so that it is noticed
const colors = new Map<string, string>();
const dark = matchMedia("(prefers-color-scheme: dark)");
dark.addEventListener("change", () => colors.clear());

/** Forget the colors: the theme has changed. */
export function forgetColors(): void {
  colors.clear();
}

export function isDark(): boolean {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : dark.matches;
}

/** A color of the style sheet by name. */
export function color(name: string): string {
  let found = colors.get(name);
  if (found === undefined) {
    found = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    colors.set(name, found);
  }
  return found;
}

export interface Pen {
  pen: CanvasRenderingContext2D;
  width: number;
  height: number;
}

/** An empty canvas in units of CSS pixels, sharp on every screen. */
export function cleared(canvas: HTMLCanvasElement): Pen {
  const { clientWidth: width, clientHeight: height } = canvas;
  const ratio = window.devicePixelRatio || 1;
  const wide = Math.round(width * ratio);
  const high = Math.round(height * ratio);
  if (canvas.width !== wide || canvas.height !== high) [canvas.width, canvas.height] = [wide, high];
  const pen = canvas.getContext("2d") as CanvasRenderingContext2D;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}

/** Text with an edge round it, readable on anything. */
export function outlinedText(pen: CanvasRenderingContext2D, text: string, x: number, y: number, fill: string): void {
  pen.lineJoin = "round";
  pen.lineWidth = 3;
  pen.strokeStyle = "#000000b0";
  pen.strokeText(text, x, y);
  pen.fillStyle = fill;
  pen.fillText(text, x, y);
}

export type Box = [x: number, y: number, width: number, height: number];

/** The first of some boxes that covers none that is taken; it is taken then. */
export function freeBox(taken: Box[], boxes: Box[]): Box | undefined {
  const covers = ([x, y, w, h]: Box, [a, b, c, d]: Box) => x < a + c && a < x + w && y < b + d && b < y + h;
  const free = boxes.find((box) => !taken.some((other) => covers(box, other)));
  if (free) taken.push(free);
  return free;
}

/** Distance on the floor at each pixel of a robot's mirror [m], null beyond the horizon: its own, or its team's. */
export function mirrorTable(field: Field, team: Color, number: number): (number | null)[] {
  return field.mirror_m[`${team} ${number}`] ?? field.mirror_m[team] ?? [];
}

/** The number of a robot by its marker; 0: no robot that plays. */
export function numberOf(field: Field, team: Color, id: number | null): number {
  return id === null ? 0 : (field.marker_ids[team] ?? []).indexOf(id) + 1;
}

/** B3 for a robot that wears the marker of blue 3; B#7 for a marker of no number, B? for none. */
export function robotLabel(field: Field, team: Color, id: number | null): string {
  const letter = team === "blue" ? "B" : "Y";
  if (id === null) return `${letter}?`;
  const number = numberOf(field, team, id);
  return number ? `${letter}${number}` : `${letter}#${id}`;
}

export interface EdgeLook {
  color: string;
  label: string;
  meaning: string;
  width: number;
}

/** How an edge's code is drawn, by the server's table of edge types: color, a label to write beside it, thickness. */
export function edgeLook(field: Field, code: number): EdgeLook {
  const type = Object.values(field.edge_types).find((one) => code >= one.code && code <= one.code + one.numbers);
  if (!type) return { color: UNDEFINED_COLOR, label: `code ${code}`, meaning: "undefined", width: 3.5 };
  const number = type.numbers ? code - type.code || "?" : "";
  return {
    color: isDark() ? type.on_dark : type.on_light,
    label: `${type.label}${number}`,
    meaning: `${type.meaning}${number ? ` ${number}` : ""}`,
    width: type.label ? 3.5 : 1.6,
  };
}

export interface Run {
  code: number;
  start: number;
  length: number;
}

/** Runs of equal edge codes round the circle, directions in degrees. */
export function runsOf(codes: ArrayLike<number>): Run[] {
  const count = codes.length;
  let first = 0;
  while (first < count && codes[first] === codes[(first + count - 1) % count]) first += 1;
  if (first === count) return count ? [{ code: codes[0] as number, start: 0, length: count }] : [];
  const runs: Run[] = [];
  for (let step = 0; step < count; step += 1) {
    const code = codes[(first + step) % count] as number;
    const last = runs.at(-1);
    if (last?.code === code) last.length += 1;
    else runs.push({ code, start: (first + step) % count, length: 1 });
  }
  return runs;
}

/** The bytes of a base64 string. */
export function bytesFrom(base64: string): Uint8Array {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}
