// Both teams' places and lags as shares of their own datagrams, for bars side by side.

import type { TeamFairness } from "../api/types";

export interface Shares {
  /** Lower end of every bar, and the upper end of the last. */
  edges: number[];
  /** For each team, the share of its datagrams in every bar. */
  teams: number[][];
}

const LAG_BARS = 30;
const MOST = 0.999; // the bars end where so many of the lags are smaller; later ones are in the last bar

export function placesOf(teams: readonly TeamFairness[]): Shares {
  return { edges: Array.from({ length: 11 }, (_, tenth) => 10 * tenth), teams: teams.map((team) => team.place_shares) };
}

export function lagsOf(teams: readonly TeamFairness[]): Shares {
  const bins = teams.flatMap((team) => team.lag_bins as [number, number][]).sort((a, b) => a[0] - b[0]);
  const total = bins.reduce((sum, [, count]) => sum + count, 0);
  let below = 0;
  const last = bins.find(([, count]) => (below += count) >= MOST * total)?.[0] ?? 1;
  const first = 0.95 * (bins[0]?.[0] ?? 0);
  const width = Math.max(last - first, 0.05 * first) / LAG_BARS;
  const edges = Array.from({ length: LAG_BARS + 1 }, (_, bar) => first + bar * width);
  return { edges, teams: teams.map((team) => sharesIn(team.lag_bins as [number, number][], first, width)) };
}

function sharesIn(bins: readonly [number, number][], first: number, width: number): number[] {
  const found = new Array<number>(LAG_BARS).fill(0);
  for (const [upper, count] of bins) {
    const bar = Math.min(Math.max(Math.floor((upper - first) / width), 0), LAG_BARS - 1);
    found[bar] = (found[bar] ?? 0) + count;
  }
  const total = found.reduce((sum, count) => sum + count, 0);
  return found.map((count) => (total ? count / total : 0));
}
