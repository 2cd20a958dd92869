// The camera's picture with what was seen in it.

import type { Field } from "../api/types";
import { cleared, color, freeBox, outlinedText, robotLabel, type Box } from "../canvas/drawing";
import type { SightingsMessage } from "../live/messages";

const BALL_RING_PX = 9;
const LABEL_HIGH_PX = 13;
const OBSTACLE_COLOR = "#f0a0f0"; // brighter than elsewhere: pictures are dark

export interface Overlays {
  robots: boolean;
  ball: boolean;
  obstacles: boolean;
  lines: boolean;
}

type Points = [number, number][];

interface Label {
  text: string;
  x: number;
  y: number;
  reach: number;
  fill: string;
  rank: number;
}

export function drawPicture(
  canvas: HTMLCanvasElement,
  bitmap: ImageBitmap,
  field: Field,
  size: { width_px: number; height_px: number },
  seen: SightingsMessage | null,
  show: Overlays,
): void {
  const { pen, width, height } = cleared(canvas);
  const scale = Math.min(width / size.width_px, height / size.height_px);
  pen.translate((width - size.width_px * scale) / 2, (height - size.height_px * scale) / 2);
  pen.drawImage(bitmap, 0, 0, size.width_px * scale, size.height_px * scale);
  pen.font = "600 11px system-ui, sans-serif";
  pen.textAlign = "center";
  if (show.lines) drawLines(pen, field.painted_px as Points[], scale);
  const sightings = seen?.sightings?.valid ? seen.sightings.value : null;
  if (!seen || !sightings) return;
  const labels: Label[] = [];
  if (show.robots) {
    sightings.robots.forEach((robot, index) => {
      const outline = seen.outlines_px[index] ?? [];
      const shade = robot.team === "blue" ? "#6cacff" : color("yellow-body");
      pen.setLineDash(robot.id === null ? [4, 3] : []);
      trace(pen, outline, scale, shade);
      if (robot.heading_rad !== null && outline[0]) {
        pen.moveTo(robot.x_px * scale, robot.y_px * scale);
        pen.lineTo(outline[0][0] * scale, outline[0][1] * scale);
      }
      pen.stroke();
      pen.setLineDash([]);
      const text = `${robotLabel(field, robot.team, robot.id)} ${Math.round(robot.confidence * 100)}%`;
      labels.push({ text, ...place(robot, outline, scale), fill: shade, rank: robot.id === null ? 3 : 2 });
    });
  }
  if (show.obstacles && seen.obstacles?.valid) {
    seen.obstacles.value.obstacles.forEach((thing, index) => {
      const outline = seen.obstacle_outlines_px[index] ?? [];
      trace(pen, outline, scale, OBSTACLE_COLOR);
      pen.stroke();
      labels.push({ text: "?", ...place(thing, outline, scale), fill: OBSTACLE_COLOR, rank: 3 });
    });
  }
  if (show.ball) sightings.balls.forEach((ball, index) => labels.push(drawBall(pen, ball, index, scale)));
  writeLabels(pen, labels, size.width_px * scale, size.height_px * scale);
}

function drawLines(pen: CanvasRenderingContext2D, lines: Points[], scale: number): void {
  pen.strokeStyle = "#5ef0ff";
  pen.lineWidth = 1;
  pen.beginPath();
  for (const line of lines) line.forEach(([x, y], index) => (index ? pen.lineTo(x * scale, y * scale) : pen.moveTo(x * scale, y * scale)));
  pen.stroke();
}

function trace(pen: CanvasRenderingContext2D, outline: Points, scale: number, shade: string): void {
  pen.strokeStyle = shade;
  pen.lineWidth = 2;
  pen.beginPath();
  for (const [x, y] of outline) pen.lineTo(x * scale, y * scale);
  pen.closePath();
}

function place(thing: { x_px: number; y_px: number }, outline: Points, scale: number): { x: number; y: number; reach: number } {
  const reach = Math.max(0, ...outline.map(([x, y]) => Math.hypot(x - thing.x_px, y - thing.y_px)));
  return { x: thing.x_px * scale, y: thing.y_px * scale, reach: reach * scale };
}

/** The best candidate is the ball; the others are drawn paler. */
function drawBall(pen: CanvasRenderingContext2D, ball: { x_px: number; y_px: number }, index: number, scale: number): Label {
  const [x, y] = [ball.x_px * scale, ball.y_px * scale];
  pen.strokeStyle = index ? "#ffffff90" : color("ball");
  pen.lineWidth = 2;
  pen.beginPath();
  pen.arc(x, y, BALL_RING_PX, 0, 2 * Math.PI);
  pen.stroke();
  return { text: index ? "ball?" : "ball", x, y, reach: BALL_RING_PX, fill: index ? "#ffffff" : "#ffb48a", rank: index ? 4 : 1 };
}

/** Each label above its thing, else below, right or left of it; the least important is left out where none is free. */
function writeLabels(pen: CanvasRenderingContext2D, labels: Label[], width: number, height: number): void {
  const taken: Box[] = [];
  for (const { text, x, y, reach, fill } of labels.sort((one, other) => one.rank - other.rank)) {
    const wide = pen.measureText(text).width + 4;
    const high = LABEL_HIGH_PX;
    const [left, top] = [x - wide / 2, y - high / 2];
    const places = [[left, y - reach - high], [left, y + reach], [x + reach, top], [x - reach - wide, top]] as [number, number][];
    const inside = places.filter(([a, b]) => a >= 0 && b >= 0 && a + wide <= width && b + high <= height);
    const box = freeBox(taken, inside.map(([a, b]) => [a, b, wide, high]));
    if (box) outlinedText(pen, text, box[0] + wide / 2, box[1] + high - 3, fill);
  }
}
