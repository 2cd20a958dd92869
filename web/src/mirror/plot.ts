// Scales of the mirror's plot: radius over distance, and below it how far beside the curve the pairs lie.

import type { FittedMirror } from "../api/types";

export interface Scale {
  of: (value: number) => number;
  ticks: number[];
}

const STEPS = [1, 2, 5];

/** Round numbers from low to high, at most as many as given. */
export function ticksOf(low: number, high: number, most: number): number[] {
  const least = (high - low) / Math.max(most, 1);
  const power = 10 ** Math.floor(Math.log10(least));
  const step = power * (STEPS.find((one) => one * power >= least * (1 - 1e-9)) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, index) => Number(((first + index) * step).toPrecision(12)));
}

export function scaleOf(low: number, high: number, from_px: number, to_px: number, most: number): Scale {
  return { of: (value) => from_px + ((value - low) / (high - low)) * (to_px - from_px), ticks: ticksOf(low, high, most) };
}

/** The line through points, as an SVG path. */
export const lineOf = (points: readonly (readonly [number, number])[]) => points.map(([x, y], index) => `${index ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");

/** How far the plot of residuals reaches to both sides [px]: all pairs that count are inside. */
export function reachOfResiduals(pairs: FittedMirror["pairs"]): number {
  const worst = Math.max(0, ...pairs.filter((pair) => pair.counts).map((pair) => Math.abs(pair.off_px ?? 0)));
  return Math.max(1, 1.15 * worst);
}
