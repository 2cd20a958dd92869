// The camera's picture with what was seen in it.

import type { Color, Field } from "../api/types";
import { cleared, color, freeBox, outlinedText, robotLabel, type Box } from "../canvas/drawing";
import type { Hypothesis, SightingsMessage } from "../live/messages";
import { drawChosen, drawLayers, type Overlay } from "./drawLayers";
import { drawMasks, type MaskLook } from "./drawMasks";
import type { Item } from "./found";
import type { Layers } from "./layers";
import { scaleOf, type Size, type View } from "./view";

const BALL_RING_PX = 9;
const LABEL_HIGH_PX = 13;
const OBSTACLE_COLOR = "#f0a0f0"; // brighter than elsewhere: pictures are dark

type Points = [number, number][];

interface Label {
  text: string;
  x: number;
  y: number;
  reach: number;
  fill: string;
  rank: number;
}

/** What is to be drawn. */
export interface Shown {
  bitmap: ImageBitmap;
  seen: SightingsMessage | null;
  overlay: Overlay;
  /** The overlay is much older than the picture. */
  isOverlayOld: boolean;
  show: Layers;
  /** What the pointer or the list is at. */
  chosen: (Item | null)[];
  masks: MaskLook;
}

const LARGE_PIXELS = 4; // canvas pixels per picture pixel from which on pixels are shown as squares

/** Draw a part of the picture with everything on it. size: of the camera's picture [px]. */
export function drawPicture(canvas: HTMLCanvasElement, field: Field, size: Size, view: View, shown: Shown): void {
  const { pen, width, height } = cleared(canvas);
  const scale = scaleOf(view, { width, height }, size);
  const drawn: [number, number] = [size.width * scale, size.height * scale];
  pen.translate(view.x, view.y);
  pen.imageSmoothingEnabled = scale < LARGE_PIXELS;
  pen.drawImage(shown.bitmap, 0, 0, ...drawn);
  pen.imageSmoothingEnabled = true;
  pen.font = "600 11px system-ui, sans-serif";
  pen.textAlign = "center";
  if (shown.isOverlayOld) pen.filter = "grayscale(1) opacity(0.55)";
  drawLayers(pen, scale, drawn, shown.overlay, shown.show.rejected);
  pen.filter = "none";
  drawMasks(pen, scale, shown.masks);
  const labels = [...thingLabels(pen, scale, field, shown), ...obstacleLabels(pen, scale, shown)];
  writeLabels(pen, labels, ...drawn);
  for (const item of shown.chosen) if (item) drawChosen(pen, scale, item);
}

/** Robots and balls: those of the overlay where there is one, since it belongs to the picture. */
function thingLabels(pen: CanvasRenderingContext2D, scale: number, field: Field, { seen, overlay, show }: Shown): Label[] {
  if (!show.robots) return [];
  if (overlay.hypotheses) return overlay.hypotheses.content.shown.filter((one) => one.is_accepted).map((one) => drawAccepted(pen, scale, field, one));
  const sightings = seen?.sightings?.valid ? seen.sightings.value : null;
  if (!seen || !sightings) return [];
  const robots = sightings.robots.map((robot, index) => {
    const outline = seen.outlines_px[index] ?? [];
    const shade = teamShade(robot.team);
    pen.setLineDash(robot.id === null ? [4, 3] : []);
    trace(pen, outline, scale, shade);
    if (robot.heading_rad !== null && outline[0]) {
      pen.moveTo(robot.x_px * scale, robot.y_px * scale);
      pen.lineTo(outline[0][0] * scale, outline[0][1] * scale);
    }
    pen.stroke();
    pen.setLineDash([]);
    const text = `${robotLabel(field, robot.team, robot.id)} ${Math.round(robot.confidence * 100)}%`;
    return { text, ...place(robot, outline, scale), fill: shade, rank: robot.id === null ? 3 : 2 };
  });
  return [...robots, ...sightings.balls.map((ball, index) => drawBall(pen, ball, index, scale))];
}

/** An accepted robot or ball of an overlay: a circle of its size. */
function drawAccepted(pen: CanvasRenderingContext2D, scale: number, field: Field, one: Hypothesis): Label {
  const percent = `${Math.round((one.confidence ?? 0) * 100)}%`;
  if (one.what === "ball") return { ...drawBall(pen, one, 0, scale), text: `ball ${percent}` };
  const team = one.what.startsWith("blue") ? "blue" : "yellow";
  const [x, y, reach] = [one.x_px * scale, one.y_px * scale, one.radius_px * scale];
  pen.strokeStyle = teamShade(team);
  pen.lineWidth = 2;
  pen.setLineDash(one.id === null ? [4, 3] : []);
  pen.beginPath();
  pen.arc(x, y, reach, 0, 2 * Math.PI);
  pen.stroke();
  pen.setLineDash([]);
  return { text: `${robotLabel(field, team, one.id)} ${percent}`, x, y, reach, fill: teamShade(team), rank: one.id === null ? 3 : 2 };
}

function obstacleLabels(pen: CanvasRenderingContext2D, scale: number, { seen, show }: Shown): Label[] {
  if (!show.obstacles || !seen?.obstacles?.valid) return [];
  return seen.obstacles.value.obstacles.map((thing, index) => {
    const outline = seen.obstacle_outlines_px[index] ?? [];
    trace(pen, outline, scale, OBSTACLE_COLOR);
    pen.stroke();
    return { text: "?", ...place(thing, outline, scale), fill: OBSTACLE_COLOR, rank: 3 };
  });
}

function teamShade(team: Color): string {
  return team === "blue" ? "#6cacff" : color("yellow-body");
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
