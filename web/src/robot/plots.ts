// The paper's figures of one view: 4, distance and type over all directions; 6, the panorama of the on-board camera.

import type { Color, Field } from "../api/types";
import { cleared, color, edgeLook, freeBox, runsOf, type Box } from "../canvas/drawing";

const DEG = Math.PI / 180;
const NO_EDGE = 255;
const LEFT = 44;
const BOTTOM = 22;
const TYPE_BAND_PX = 14;
const RINGS_M = [0.25, 0.5, 1, 2, 4, 8];
const MIN_RING_GAP_PX = 7;
const BALL_PX = 9;

export type MirrorTable = readonly (number | null)[];

export interface RobotView {
  kinds: Uint8Array;
  px: Uint8Array;
  ball_px: number;
  ball_direction_deg: number;
  ball_size_deg: number;
}

/** Figure 4: the distance of the nearest edge over the direction, its type as color above and below the curve. */
export function drawDistances(canvas: HTMLCanvasElement, field: Field, view: RobotView): void {
  const { pen, width, height } = cleared(canvas);
  const wide = width - LEFT - 6;
  const high = height - BOTTOM - TYPE_BAND_PX - 8;
  const top = TYPE_BAND_PX + 4;
  const highest = Math.max(50, Math.ceil(Math.max(...[...view.px].filter((px) => px !== NO_EDGE), view.ball_px) / 25) * 25);
  const x = (direction: number) => LEFT + (direction / 360) * wide;
  const y = (px: number) => top + high - (Math.min(px, highest) / highest) * high;
  drawAxes(pen, { x, y, width, height, top, high, highest });
  for (const { code, start, length } of runsOf(view.kinds)) {
    if (code === field.edge_types.nothing?.code) continue;
    pen.fillStyle = pen.strokeStyle = edgeLook(field, code).color;
    for (let step = 0; step < length; step += 1) {
      const direction = (start + step) % 360;
      pen.fillRect(x(direction), 2, wide / 360 + 0.5, TYPE_BAND_PX - 4);
    }
    pen.lineWidth = 2;
    pen.beginPath();
    for (let step = 0, last = -1; step < length; step += 1) {
      const direction = (start + step) % 360;
      if (direction < last) pen.moveTo(x(direction), y(view.px[direction] ?? 0)); // the run goes over 360 degrees
      pen.lineTo(x(direction), y(view.px[direction] ?? 0));
      pen.lineTo(x(direction + 1), y(view.px[direction] ?? 0));
      last = direction;
    }
    pen.stroke();
  }
  if (view.ball_px >= 0) {
    pen.fillStyle = color("ball");
    pen.strokeStyle = color("ink");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.arc(x(view.ball_direction_deg + 0.5), y(view.ball_px), BALL_PX / 2, 0, 2 * Math.PI);
    pen.fill();
    pen.stroke();
  }
}

interface Axes {
  x: (direction: number) => number;
  y: (px: number) => number;
  width: number;
  height: number;
  top: number;
  high: number;
  highest: number;
}

function drawAxes(pen: CanvasRenderingContext2D, { x, y, width, top, high, highest, height }: Axes): void {
  pen.strokeStyle = color("line");
  pen.fillStyle = color("dim");
  pen.lineWidth = 1;
  pen.font = "11px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.beginPath();
  for (let direction = 0; direction <= 360; direction += 45) {
    pen.moveTo(x(direction), top);
    pen.lineTo(x(direction), top + high);
    pen.fillText(`${direction}°`, Math.min(x(direction), width - 14), height - 7);
  }
  pen.textAlign = "right";
  for (let px = 0; px <= highest; px += highest > 100 ? 50 : 25) {
    pen.moveTo(x(0), y(px));
    pen.lineTo(x(360), y(px));
    pen.fillText(`${px} px`, x(0) - 5, y(px) + 4);
  }
  pen.stroke();
}

/**
 * Figure 6: as the robot's camera would see it in its mirror, heading up. The radius is in pixels of the mirror.
 * table: metres at each of its pixels. least_px: so far the picture reaches at least.
 */
export function drawPanorama(canvas: HTMLCanvasElement, field: Field, team: Color, view: RobotView, table: MirrorTable, least_px = 0): void {
  const { pen, width, height } = cleared(canvas);
  const outer = Math.min(width, height) / 2 - 1;
  const rings = RINGS_M.map((metres) => pxOf(table, metres));
  const farthest = Math.max(reachOf(field, table), least_px);
  const scale = (outer - 2) / farthest;
  const place = (direction: number, radius: number): [number, number] => [-radius * Math.sin(direction * DEG), -radius * Math.cos(direction * DEG)];
  const radius = (direction: number) => Math.min(view.px[direction] === NO_EDGE ? farthest : (view.px[direction] ?? 0), farthest) * scale;
  pen.translate(width / 2, height / 2);
  pen.beginPath();
  pen.arc(0, 0, outer, 0, 2 * Math.PI);
  pen.fillStyle = color("dial");
  pen.fill();
  pen.beginPath();
  for (let direction = 0; direction < 360; direction += 1) pen.lineTo(...place(direction, radius(direction)));
  pen.closePath();
  pen.fillStyle = color("seen");
  pen.fill();
  drawRings(pen, rings, scale);
  const runs = runsOf(view.kinds).filter(({ code }) => code !== field.edge_types.nothing?.code);
  for (const { code, start, length } of runs) {
    const look = edgeLook(field, code);
    pen.strokeStyle = look.color;
    pen.lineWidth = look.width;
    pen.lineJoin = "round";
    pen.beginPath();
    for (let step = 0; step < length; step += 1) {
      const direction = (start + step) % 360;
      pen.lineTo(...place(direction - 0.5, radius(direction)));
      pen.lineTo(...place(direction + 0.5, radius(direction)));
    }
    pen.stroke();
  }
  const ball = view.ball_px < 0 ? null : place(view.ball_direction_deg, view.ball_px * scale);
  writeLabels(pen, field, runs, place, radius, ball);
  if (ball) drawBall(pen, ball, view, scale, place);
  drawBody(pen, field, team, table, scale);
}

type Place = (direction: number, radius: number) => [number, number];

/** Names beside the edges, the widest first; one that would cover another, the robot or the ball is left out. */
function writeLabels(pen: CanvasRenderingContext2D, field: Field, runs: ReturnType<typeof runsOf>, place: Place, radius: (direction: number) => number, ball: [number, number] | null): void {
  const square = ([x, y]: [number, number], size: number): Box => [x - size / 2, y - size / 2, size, size];
  const taken: Box[] = [square([0, 0], 20), ...(ball ? [square(ball, BALL_PX)] : [])];
  pen.font = "700 10px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  for (const run of [...runs].sort((one, other) => other.length - one.length)) {
    const look = edgeLook(field, run.code);
    if (!look.label || run.length < 4) continue;
    const middle = run.start + run.length / 2;
    const [x, y] = place(middle, Math.max(radius(Math.floor(middle) % 360) - 9, 0));
    if (!freeBox(taken, [[x - 7, y - 5, 14, 10]])) continue;
    pen.fillStyle = look.color;
    pen.fillText(look.label, x, y);
  }
  pen.textBaseline = "alphabetic";
}

function drawBall(pen: CanvasRenderingContext2D, [x, y]: [number, number], view: RobotView, scale: number, place: Place): void {
  const half = view.ball_size_deg / 2;
  pen.strokeStyle = color("ball");
  pen.lineWidth = 5;
  pen.beginPath();
  for (let offset = -half; offset <= half; offset += 1) pen.lineTo(...place(view.ball_direction_deg + offset, view.ball_px * scale));
  pen.stroke();
  pen.beginPath();
  pen.arc(x, y, BALL_PX / 2, 0, 2 * Math.PI);
  pen.fillStyle = color("ball");
  pen.fill();
  pen.lineWidth = 1;
  pen.strokeStyle = color("ink");
  pen.stroke();
}

function pxOf(table: MirrorTable, metres: number): number {
  const beyond = table.findIndex((value) => value === null || value > metres);
  return beyond < 0 ? table.length - 1 : beyond;
}

/** Pixels of a mirror up to the field's diagonal. */
export function reachOf(field: Field, table: MirrorTable): number {
  return pxOf(table, Math.hypot(field.length_m, field.width_m)) + 2;
}

function drawRings(pen: CanvasRenderingContext2D, rings: number[], scale: number): void {
  pen.strokeStyle = color("ring");
  pen.lineWidth = 0.8;
  let last = 0;
  for (const px of rings) {
    if ((px - last) * scale < MIN_RING_GAP_PX) continue;
    last = px;
    pen.beginPath();
    pen.arc(0, 0, px * scale, 0, 2 * Math.PI);
    pen.stroke();
  }
}

function drawBody(pen: CanvasRenderingContext2D, field: Field, team: Color, table: MirrorTable, scale: number): void {
  const radius_m = field.robots[team]?.radius_m ?? 0.09;
  const size = Math.min(Math.max(pxOf(table, radius_m) * scale, 4), 9);
  pen.fillStyle = color("dim");
  pen.beginPath();
  pen.moveTo(0, -size);
  pen.lineTo(size * 0.7, size * 0.7);
  pen.lineTo(0, size * 0.35);
  pen.lineTo(-size * 0.7, size * 0.7);
  pen.fill();
}
