// Masks over the picture: dark, with a dashed edge; the chosen one with its points.

import { outlinedText } from "../canvas/drawing";
import type { Mask, Point } from "./masks";

export interface MaskLook {
  masks: readonly Mask[];
  draft: readonly Point[] | null;
  chosen: number;
  point: number;
}

const EDGE = "#ffffff";
const FILL = "#00000090";
const POINT_PX = 5;

export function drawMasks(pen: CanvasRenderingContext2D, scale: number, look: MaskLook): void {
  look.masks.forEach((mask, index) => {
    trace(pen, scale, mask.points_px);
    pen.closePath();
    pen.fillStyle = FILL;
    pen.fill();
    stroke(pen, index === look.chosen ? [] : [7, 4]);
    const [x, y] = mask.points_px[0] ?? [0, 0];
    pen.textAlign = "left";
    outlinedText(pen, mask.name, x * scale + 6, y * scale + 14, EDGE);
    pen.textAlign = "center";
    if (index === look.chosen) drawPoints(pen, scale, mask.points_px, look.point);
  });
  if (look.draft) {
    trace(pen, scale, look.draft);
    stroke(pen, []);
    drawPoints(pen, scale, look.draft, look.point);
  }
}

function trace(pen: CanvasRenderingContext2D, scale: number, points: readonly Point[]): void {
  pen.beginPath();
  points.forEach(([x, y], index) => (index ? pen.lineTo(x * scale, y * scale) : pen.moveTo(x * scale, y * scale)));
}

function stroke(pen: CanvasRenderingContext2D, dash: number[]): void {
  pen.strokeStyle = EDGE;
  pen.lineWidth = 2;
  pen.setLineDash(dash);
  pen.stroke();
  pen.setLineDash([]);
}

function drawPoints(pen: CanvasRenderingContext2D, scale: number, points: readonly Point[], chosen: number): void {
  points.forEach(([x, y], index) => {
    const reach = index === chosen ? POINT_PX + 2 : POINT_PX;
    pen.fillStyle = index === chosen ? "#ffd23f" : EDGE;
    pen.strokeStyle = "#000000";
    pen.lineWidth = 1;
    pen.beginPath();
    pen.rect(x * scale - reach, y * scale - reach, 2 * reach, 2 * reach);
    pen.fill();
    pen.stroke();
  });
}
