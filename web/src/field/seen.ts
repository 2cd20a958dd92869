// A view laid on the floor: per direction the near and the far end of what the edge's pixel of the mirror spans.

import type { Field } from "../api/types";
import { color, edgeLook, mirrorTable, runsOf, type Run } from "../canvas/drawing";
import type { View, WorldRobot } from "../live/messages";
import type { FieldMap } from "./map";

const RAY_EVERY_DEG = 10;
type Point = [number, number];

export interface Seen {
  near: Point[];
  far: Point[];
  runs: Run[];
}

/** thinnest_m: a band is drawn at least this wide. */
export function seenBand(field: Field, view: View, own: WorldRobot, thinnest_m: number): Seen {
  const beyond = 2 * Math.hypot(field.length_m, field.width_m);
  const table = mirrorTable(field, view.team, view.number);
  const metres = (px: number) => table[px] ?? beyond;
  const reachOf = (px: number) => {
    const whole = Math.floor(px);
    return metres(whole) + (px % 1) * (metres(whole + 1) - metres(whole));
  };
  const on = (reach: number, direction: number): Point => {
    const angle = own.heading_rad + (direction * Math.PI) / 180;
    return [own.x_m + reach * Math.cos(angle), own.y_m + reach * Math.sin(angle)];
  };
  const runs = runsOf(view.kinds);
  const middles = evened(view.px, runs);
  const near = middles.map((px) => reachOf(Math.max(px - 0.5, 0)));
  const far = middles.map((px, direction) => Math.max(reachOf(px + 0.5), (near[direction] ?? 0) + thinnest_m));
  return { near: near.map(on), far: far.map(on), runs };
}

/** Pixels without their steps: where an edge passes from one pixel to the next, its distance is known exactly. */
export function evened(px: ArrayLike<number>, runs: Run[]): number[] {
  const even = new Array<number>(px.length).fill(0);
  for (const { start, length } of runs) {
    const at = (step: number) => px[(start + step) % px.length] ?? 0;
    const border = (step: number) => (at(Math.max(step - 1, 0)) + at(Math.min(step, length - 1)) + 1) / 2;
    for (let first = 0, end = 0; first < length; first = end) {
      while (end < length && at(end) === at(first)) end += 1;
      const [from, to] = [border(first), border(end)];
      for (let step = first; step < end; step += 1) {
        even[(start + step) % px.length] = from + ((to - from) * (step - first + 0.5)) / (end - first);
      }
    }
  }
  return even;
}

export function drawSeenArea(pen: CanvasRenderingContext2D, map: FieldMap, seen: Seen, own: WorldRobot): void {
  pen.beginPath();
  for (const [x, y] of seen.near) pen.lineTo(...map.at(x, y));
  pen.closePath();
  pen.fillStyle = "#ffffff2e";
  pen.fill();
  pen.strokeStyle = "#ffffff40";
  pen.lineWidth = 1;
  pen.beginPath();
  for (let direction = 0; direction < seen.near.length; direction += RAY_EVERY_DEG) {
    pen.moveTo(...map.at(own.x_m, own.y_m));
    pen.lineTo(...map.at(...(seen.near[direction] as Point)));
  }
  pen.stroke();
}

export function drawSeenEdges(pen: CanvasRenderingContext2D, map: FieldMap, field: Field, seen: Seen): void {
  const count = seen.near.length;
  const nothing = field.edge_types.nothing?.code;
  const wall = field.edge_types.wall?.code;
  for (const { code, start, length } of seen.runs) {
    if (code === nothing) continue;
    pen.beginPath();
    for (let step = 0; step < length; step += 1) pen.lineTo(...map.at(...(seen.near[(start + step) % count] as Point)));
    for (let step = length - 1; step >= 0; step -= 1) pen.lineTo(...map.at(...(seen.far[(start + step) % count] as Point)));
    pen.closePath();
    pen.globalAlpha = code === wall ? 0.22 : 0.6;
    pen.fillStyle = code === wall ? color("carpet-line") : edgeLook(field, code).color;
    pen.fill();
  }
  pen.globalAlpha = 1;
}
