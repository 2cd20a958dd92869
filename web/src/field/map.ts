// From field space [m] to a canvas and back.

import type { Color, Field, Robot } from "../api/types";
import { numberOf } from "../canvas/drawing";
import type { WorldMessage } from "../live/messages";

const PADDING_M = 0.06;
const MIN_TARGET_PX = 14;

export interface FieldMap {
  scale: number;
  at: (x_m: number, y_m: number) => [number, number];
}

/** Where the field is on a canvas. */
export function mapping(field: Field, width: number, height: number): FieldMap {
  const ends = field.segments.flatMap((s) => [
    [s.x1_m, s.y1_m],
    [s.x2_m, s.y2_m],
  ]) as [number, number][];
  const halfX = Math.max(field.length_m / 2, ...ends.map(([x]) => Math.abs(x))) + PADDING_M;
  const halfY = Math.max(field.width_m / 2, ...ends.map(([, y]) => Math.abs(y))) + PADDING_M;
  const scale = Math.min(width / (2 * halfX), height / (2 * halfY));
  return { scale, at: (x, y) => [width / 2 + x * scale, height / 2 - y * scale] };
}

/** The share of height to width that the field needs. */
export function aspectOf(field: Field): number {
  const map = mapping(field, 1000, 1e9);
  return mapping(field, 1e9, 1000).scale / map.scale;
}

export interface Pick extends Robot {
  id: number | null;
}

/** The robot under a point of the canvas, number 0 for one that does not play; null: none. */
export function robotAt(map: FieldMap, field: Field, world: WorldMessage, x: number, y: number): Pick | null {
  let found: Pick | null = null;
  let nearest = Infinity;
  for (const robot of world.robots) {
    const [rx, ry] = map.at(robot.x_m, robot.y_m);
    const away = Math.hypot(x - rx, y - ry);
    const reach = Math.max((field.robots[robot.team]?.radius_m ?? 0) * map.scale, MIN_TARGET_PX);
    if (away < nearest && away <= reach) {
      nearest = away;
      found = { team: robot.team, id: robot.id, number: numberOf(field, robot.team as Color, robot.id) };
    }
  }
  return found;
}
