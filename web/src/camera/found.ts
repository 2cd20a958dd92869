// What an overlay shows, as items of a list: the picture and the list point at the same things.

import type { HypothesesMessage, BlobsMessage, LinesMessage } from "../live/messages";

export type Box = [left: number, top: number, right: number, bottom: number];
export type Kind = "rejected" | "accepted" | "blob" | "line";

export interface Item {
  kind: Kind;
  title: string;
  /** Why, in one line; empty where there is nothing to say. */
  why: string;
  x: number;
  y: number;
  box: Box;
  facts: [name: string, value: string][];
}

const NEAR_PX = 30; // what has moved farther between two overlays is another thing
const REACH_PX = 4; // beside a box that still counts as it

export function hypothesisItems(message: HypothesesMessage | null): Item[] {
  return (message?.content.shown ?? []).map((one) => {
    const name = one.what === "ball" || one.id === null ? one.what : `${one.what}, marker ${one.id}`;
    const facts: Item["facts"] = [["place", place(one.x_px, one.y_px)]];
    if (one.confidence !== null) facts.push(["confidence", one.confidence.toFixed(2)]);
    if (one.gate) facts.push(["verdict", one.gate], ["found", one.found], ["accepted", one.accepted]);
    const why = one.gate ? `${one.gate}: ${one.found}; accepted: ${one.accepted}` : "";
    return { kind: one.is_accepted ? "accepted" : "rejected", title: name, why, x: one.x_px, y: one.y_px, box: one.box_px, facts };
  });
}

export function blobItems(message: BlobsMessage | null): Item[] {
  return (message?.content.shown ?? []).map((blob) => {
    const [left, top, right, bottom] = blob.box_px;
    const facts: Item["facts"] = [
      ["color class", blob.color],
      ["place", place(blob.x_px, blob.y_px)],
      ["area", `${blob.area_px} px`],
      ["box", `${right - left + 1}×${bottom - top + 1} px`],
    ];
    return { kind: "blob", title: `${blob.color}, ${blob.area_px} px`, why: "", x: blob.x_px, y: blob.y_px, box: blob.box_px, facts };
  });
}

export function lineItems(message: LinesMessage | null): Item[] {
  return (message?.content ?? []).flatMap((line, index) => {
    if (!line.points_px.length) return [];
    const xs = line.points_px.map(([x]) => x);
    const ys = line.points_px.map(([, y]) => y);
    const box: Box = [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
    const [x, y] = line.points_px[Math.floor(line.points_px.length / 2)]!;
    const facts: Item["facts"] = [["place", place(x, y)]];
    if (line.offset_px !== null) facts.push(["off", `${line.offset_px.toFixed(1)} px`]);
    if (line.found) facts.push(["found", line.found], ["accepted", line.accepted]);
    const why = line.is_found ? "" : `${line.found}; accepted: ${line.accepted}`;
    return [{ kind: "line", title: `line ${index + 1}: ${line.is_found ? "found" : "missed"}`, why, x, y, box, facts }];
  });
}

/** The item at a pixel: of several the smallest. */
export function itemAt(items: Item[], x: number, y: number): Item | null {
  const hit = items.filter(({ kind, box: [left, top, right, bottom] }) => kind !== "line" && x >= left - REACH_PX && x <= right + REACH_PX && y >= top - REACH_PX && y <= bottom + REACH_PX);
  const size = ({ box: [left, top, right, bottom] }: Item) => (right - left) * (bottom - top);
  return hit.reduce<Item | null>((best, item) => (best === null || size(item) < size(best) ? item : best), null);
}

/** The same thing in a newer overlay: the nearest of its kind and title, or of its kind alone; null: it is gone. */
export function followed(items: Item[], item: Item | null): Item | null {
  if (!item) return null;
  const away = (other: Item) => Math.hypot(other.x - item.x, other.y - item.y);
  const near = items.filter((other) => other.kind === item.kind && away(other) <= NEAR_PX);
  const same = near.filter((other) => other.title === item.title);
  return (same.length ? same : near).reduce<Item | null>((best, other) => (best === null || away(other) < away(best) ? other : best), null);
}

function place(x: number, y: number): string {
  return `(${x.toFixed(0)}, ${y.toFixed(0)}) px`;
}
