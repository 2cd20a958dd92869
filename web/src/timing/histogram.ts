// A histogram of durations: bars over the logarithm of the duration, as high as the logarithm of how often it came.

import type { Histogram } from "../api/types";
import { cleared, color } from "../canvas/drawing";
import { counted, milliseconds } from "../canvas/words";

const FIRST_DECADE = -2; // 0.01 ms at the left
const DECADES = 5;

/** budget_ms: a line at a task's budget; 0: none. */
export function drawHistogram(canvas: HTMLCanvasElement, histogram: Histogram | undefined, budget_ms: number): void {
  const { pen, width, height } = cleared(canvas);
  const at = (value_ms: number) => Math.min(Math.max((Math.log10(value_ms) - FIRST_DECADE) / DECADES, 0), 1) * width;
  pen.fillStyle = color("line");
  for (let decade = 0; decade <= DECADES; decade += 1) pen.fillRect(Math.min(Math.round((decade / DECADES) * width), width - 1), 0, 1, height);
  if (budget_ms) {
    pen.fillStyle = color("wait");
    pen.fillRect(Math.round(at(budget_ms)), 0, 1, height);
  }
  const bars = new Float64Array(Math.ceil(width / 2) + 1);
  for (const [upper_ms, number] of (histogram?.bins ?? []) as [number, number][]) {
    const bar = Math.floor(at(upper_ms) / 2);
    bars[bar] = (bars[bar] ?? 0) + number;
  }
  const highest = Math.log1p(Math.max(...bars));
  pen.fillStyle = color("focus");
  bars.forEach((number, index) => {
    const tall = number ? Math.max(1, Math.round((Math.log1p(number) / highest) * height)) : 0;
    pen.fillRect(2 * index, height - tall, 2, tall);
  });
}

export function histogramWords(histogram: Histogram | undefined): string {
  if (!histogram?.count) return "no run yet";
  return `${counted(histogram.count, "run")}: half within ${milliseconds(histogram.p50)} ms, 99 % within ${milliseconds(histogram.p99)} ms, all within ${milliseconds(histogram.max)} ms`;
}
