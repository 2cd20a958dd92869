// The layers of an overlay: classes, blobs, hypotheses, lines, end of the carpet, contours.

import { outlinedText } from "../canvas/drawing";
import type { BlobsMessage, BoundaryMessage, ContoursMessage, Hypothesis, HypothesesMessage, LinesMessage } from "../live/messages";
import type { ClassRaster } from "./classes";
import type { Item } from "./found";

export const REJECTED_COLOR = "#ff9d8a";
const BLOB_COLOR = "#ffffff";
const FOUND_COLOR = "#5ef0ff";
const BOUNDARY_COLOR = "#ffe27a";
const CONTOUR_COLOR = "#ffffff";
const CHOSEN_COLOR = "#ffffff";
const DIMMED = "#000000b0";

export interface Overlay {
  classes: ClassRaster | null;
  blobs: BlobsMessage | null;
  hypotheses: HypothesesMessage | null;
  lines: LinesMessage | null;
  boundary: BoundaryMessage | null;
  contours: ContoursMessage | null;
}

/** Draw all layers that there are. scale: canvas pixels per picture pixel; size: of the picture [canvas px]. */
export function drawLayers(pen: CanvasRenderingContext2D, scale: number, size: [number, number], overlay: Overlay, showRejected: boolean): void {
  if (overlay.classes) drawClasses(pen, scale, size, overlay.classes);
  for (const line of overlay.lines?.content ?? []) drawLine(pen, scale, line.points_px, line.is_found);
  for (const contour of overlay.contours?.content ?? []) drawContour(pen, scale, contour.outline_px, contour.can_hide_ball);
  if (overlay.boundary) drawBoundary(pen, scale, overlay.boundary);
  for (const blob of overlay.blobs?.content.shown ?? []) drawBox(pen, scale, blob.box_px, BLOB_COLOR, 1);
  if (showRejected) for (const one of overlay.hypotheses?.content.shown ?? []) if (!one.is_accepted) drawRejected(pen, scale, one);
}

/** A frame round an item that the list or the pointer is at. */
export function drawChosen(pen: CanvasRenderingContext2D, scale: number, item: Item): void {
  const [left, top, right, bottom] = item.box;
  const reach = 4;
  for (const shade of ["#000000c0", CHOSEN_COLOR]) {
    pen.strokeStyle = shade;
    pen.lineWidth = shade === CHOSEN_COLOR ? 2 : 5;
    pen.strokeRect(left * scale - reach, top * scale - reach, (right - left + 1) * scale + 2 * reach, (bottom - top + 1) * scale + 2 * reach);
  }
}

function drawClasses(pen: CanvasRenderingContext2D, scale: number, [width, height]: [number, number], { canvas, step }: ClassRaster): void {
  pen.fillStyle = DIMMED;
  pen.fillRect(0, 0, width, height);
  pen.imageSmoothingEnabled = false;
  pen.drawImage(canvas, 0, 0, canvas.width * step * scale, canvas.height * step * scale);
  pen.imageSmoothingEnabled = true;
}

function drawLine(pen: CanvasRenderingContext2D, scale: number, points: [number, number][], isFound: boolean): void {
  pen.strokeStyle = isFound ? FOUND_COLOR : REJECTED_COLOR;
  pen.lineWidth = isFound ? 1.5 : 2.5;
  pen.setLineDash(isFound ? [] : [6, 5]);
  pen.beginPath();
  points.forEach(([x, y], index) => (index ? pen.lineTo(x * scale, y * scale) : pen.moveTo(x * scale, y * scale)));
  pen.stroke();
  pen.setLineDash([]);
}

function drawBoundary(pen: CanvasRenderingContext2D, scale: number, message: BoundaryMessage): void {
  pen.fillStyle = BOUNDARY_COLOR;
  for (const [x, y] of message.content.points_px) {
    if (x === null || y === null) continue;
    pen.fillRect(x * scale - 2, y * scale - 2, 4, 4);
  }
}

/** A thick line says that a ball may be hidden behind the robot. */
function drawContour(pen: CanvasRenderingContext2D, scale: number, points: [number | null, number | null][], isThick: boolean): void {
  pen.strokeStyle = CONTOUR_COLOR;
  pen.lineWidth = isThick ? 3 : 1;
  pen.beginPath();
  for (const [x, y] of points) if (x !== null && y !== null) pen.lineTo(x * scale, y * scale);
  pen.closePath();
  pen.stroke();
}

function drawBox(pen: CanvasRenderingContext2D, scale: number, [left, top, right, bottom]: readonly number[], shade: string, wide: number): void {
  pen.strokeStyle = shade;
  pen.lineWidth = wide;
  pen.strokeRect(left! * scale, top! * scale, (right! - left! + 1) * scale, (bottom! - top! + 1) * scale);
}

/** A dashed box with a cross: the shape says it without its color. */
function drawRejected(pen: CanvasRenderingContext2D, scale: number, one: Hypothesis): void {
  const [left, top, right, bottom] = one.box_px;
  pen.setLineDash([4, 3]);
  drawBox(pen, scale, one.box_px, REJECTED_COLOR, 2);
  pen.setLineDash([]);
  outlinedText(pen, "×", ((left + right + 1) / 2) * scale, ((top + bottom + 1) / 2) * scale + 4, REJECTED_COLOR);
}
