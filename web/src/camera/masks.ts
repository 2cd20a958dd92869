// Masks of the camera while they are edited: polygons in pixels of its picture, and the one that is being drawn.

import { computed, reactive } from "vue";

export type Point = [x: number, y: number];
export interface Mask {
  name: string;
  points_px: Point[];
}

export const MIN_POINTS = 3;
export const MAX_POINTS = 32;
export const MAX_MASKS = 16;

export type MaskEditor = ReturnType<typeof maskEditor>;

/** The editor of some masks. size: of the picture [px]; points are kept inside it. */
export function maskEditor(size: () => { width: number; height: number }) {
  const state = reactive({
    masks: [] as Mask[],
    saved: "[]",
    draft: null as Point[] | null,
    /** Number of the mask whose points can be dragged, and of the point that Delete removes; -1: none. */
    chosen: -1,
    point: -1,
  });
  const isDirty = computed(() => JSON.stringify(state.masks) !== state.saved);
  const isActive = computed(() => state.draft !== null || state.chosen >= 0);
  const points = () => state.draft ?? state.masks[state.chosen]?.points_px ?? [];

  function load(masks: readonly Mask[]): void {
    state.saved = JSON.stringify(masks);
    state.masks = JSON.parse(state.saved) as Mask[];
    choose(-1);
  }

  function choose(index: number): void {
    Object.assign(state, { draft: null, chosen: index, point: -1 });
  }

  function begin(): void {
    choose(-1);
    state.draft = [];
  }

  /** Add a mask in the middle of the picture, whose coordinates are then written. */
  function addWritten(): void {
    const { width, height } = size();
    const corners: Point[] = [[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]];
    state.masks.push({ name: freeName(state.masks), points_px: corners.map(([x, y]) => within([x * width, y * height])) });
    choose(state.masks.length - 1);
  }

  function within([x, y]: Point): Point {
    const { width, height } = size();
    const kept = (at: number, most: number) => Math.round(Math.min(Math.max(at, 0), most) * 10) / 10;
    return [kept(x, width), kept(y, height)];
  }

  /** Add a point to the mask that is drawn. */
  function add(point: Point): void {
    if (state.draft && state.draft.length < MAX_POINTS) state.point = state.draft.push(within(point)) - 1;
  }

  function move(point: Point): void {
    const own = points();
    if (own[state.point]) own[state.point] = within(point);
  }

  /** Remove the point that is chosen; a mask keeps three. */
  function removePoint(): void {
    const own = points();
    if (!own[state.point] || (!state.draft && own.length <= MIN_POINTS)) return;
    own.splice(state.point, 1);
    state.point = Math.min(state.point, own.length - 1);
  }

  /** Make a mask of what was drawn; false: it has too few points. */
  function close(): boolean {
    if (!state.draft) {
      choose(-1);
      return true;
    }
    if (state.draft.length < MIN_POINTS) return false;
    state.masks.push({ name: freeName(state.masks), points_px: state.draft });
    choose(state.masks.length - 1);
    return true;
  }

  function remove(index: number): void {
    state.masks.splice(index, 1);
    choose(-1);
  }

  /** Choose the point within reach of a pixel; false: there is none. */
  function take(x: number, y: number, reach: number): boolean {
    const away = points().map(([a, b]) => Math.hypot(a - x, b - y));
    const nearest = away.indexOf(Math.min(...away));
    if (!away.length || away[nearest]! > reach) return false;
    state.point = nearest;
    return true;
  }

  return { state, isDirty, isActive, load, choose, begin, add, addWritten, move, removePoint, close, cancel: () => choose(-1), remove, take };
}

function freeName(masks: readonly Mask[]): string {
  let number = masks.length + 1;
  while (masks.some(({ name }) => name === `mask ${number}`)) number += 1;
  return `mask ${number}`;
}

/** One point per line: "120, 45". */
export function pointsText(points: readonly Point[]): string {
  return points.map(([x, y]) => `${x}, ${y}`).join("\n");
}

/** The points in a text; a sentence where it is none. */
export function pointsIn(text: string): Point[] | string {
  const lines = text.split("\n").filter((line) => line.trim());
  const points = lines.map((line) => line.split(/[\s,;]+/).filter(Boolean).map(Number));
  const wrong = points.findIndex((point) => point.length !== 2 || !point.every(Number.isFinite));
  if (wrong >= 0) return `line ${wrong + 1}: ${lines[wrong]!.slice(0, 40)}; accepted: two numbers, as 120, 45`;
  if (points.length < MIN_POINTS || points.length > MAX_POINTS) return `${points.length} points; accepted: ${MIN_POINTS} to ${MAX_POINTS}`;
  return points as Point[];
}
