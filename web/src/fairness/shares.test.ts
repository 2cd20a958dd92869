import { describe, expect, it } from "vitest";

import type { TeamFairness } from "../api/types";
import { lagsOf, placesOf } from "./shares";

const team = (lag_bins: [number, number][], place_shares: number[] = []) => ({ place_shares, lag_bins }) as unknown as TeamFairness;
const sum = (shares: readonly number[]) => shares.reduce((total, share) => total + share, 0);

describe("both teams' shares", () => {
  it("has a bar for each tenth of the order", () => {
    const { edges, teams } = placesOf([team([], new Array<number>(10).fill(0.1))]);
    expect([edges.length, edges[0], edges[10], teams[0]?.length]).toEqual([11, 0, 100, 10]);
  });
  it("counts every datagram once, late ones in the last bar", () => {
    const { edges, teams } = lagsOf([team([[10, 900], [11, 99], [400, 1]]), team([[10.5, 2000]])]);
    expect(teams.map(sum)).toEqual([expect.closeTo(1), expect.closeTo(1)]);
    expect(edges.at(-1)).toBeLessThan(12);
    expect(teams[0]?.at(-1)).toBeCloseTo(0.1);
  });
  it("is empty without datagrams", () => {
    expect(lagsOf([team([]), team([])]).teams.map(sum)).toEqual([0, 0]);
  });
});
