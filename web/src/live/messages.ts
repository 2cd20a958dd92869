// What the live connection delivers, by topic; docs/live.md describes every field.

import type { Color, Log, Match, Status, Task, Timing } from "../api/types";

export interface StatusMessage {
  topic: "status";
  now_s: number;
  pages: number;
  revision: number;
  match: Match;
  status: Status;
}

export interface WorldRobot {
  team: Color;
  id: number | null;
  x_m: number;
  y_m: number;
  heading_rad: number;
  heading_sd_rad: number;
  covariance: [number, number, number];
  vx_m_s: number;
  vy_m_s: number;
  age_s: number;
}

export interface WorldBall {
  x_m: number;
  y_m: number;
  vx_m_s: number;
  vy_m_s: number;
  hidden: boolean;
  age_s: number;
}

export interface WorldObstacle {
  x_m: number;
  y_m: number;
  radius_m: number;
}

export interface WorldMessage {
  topic: "world";
  now_s: number;
  grabbed_s: number;
  age_s: number;
  valid: boolean;
  robots: WorldRobot[];
  ball: WorldBall | null;
  obstacles: WorldObstacle[];
}

export interface View {
  team: Color;
  number: number;
  ball_px: number;
  ball_direction_deg: number;
  ball_size_deg: number;
  kinds: Uint8Array;
  px: Uint8Array;
}

export interface ViewsMessage {
  topic: "views";
  grabbed_s: number;
  views: View[];
}

export interface PictureMessage {
  topic: "picture";
  number: number;
  grabbed_s: number;
  bitmap: ImageBitmap;
}

export interface RobotViewMessage {
  topic: string;
  now_s: number;
  grabbed_s: number;
  message: string;
  kinds: string;
  px: string;
  ball_px: number;
  ball_direction_deg: number;
  ball_size_deg: number;
  valid: boolean;
}

export interface TimingMessage {
  topic: "timing";
  now_s: number;
  tasks: Task[];
  timing: Timing;
}

export interface LogMessage extends Log {
  topic: "log";
  now_s: number;
}

interface OverlayMessage<T> {
  topic: string;
  now_s: number;
  grabbed_s: number;
  frame: number;
  content: T;
}

type BoxPx = [left: number, top: number, right: number, bottom: number];

export type ClassesMessage = OverlayMessage<{ step_px: number; png: string; colors: { name: string; bgr: [number, number, number] }[] }>;
export type BlobsMessage = OverlayMessage<{
  shown: { color: string; x_px: number; y_px: number; area_px: number; box_px: BoxPx }[];
  count: number;
}>;
export interface Hypothesis {
  what: string;
  id: number | null;
  is_accepted: boolean;
  x_px: number;
  y_px: number;
  radius_px: number;
  box_px: BoxPx;
  confidence: number | null;
  gate: string;
  found: string;
  accepted: string;
}
export type HypothesesMessage = OverlayMessage<{ shown: Hypothesis[]; count: number }>;
export type LinesMessage = OverlayMessage<{ points_px: [number, number][]; is_found: boolean; offset_px: number | null; found: string; accepted: string }[]>;
export type ContoursMessage = OverlayMessage<{ team: Color; id: number | null; outline_px: [number | null, number | null][]; can_hide_ball: boolean }[]>;
export type BoundaryMessage = OverlayMessage<{ points_px: [number | null, number | null][]; confidences: number[]; found: number; error_px: number | null; off_px: number | null }>;

const PICTURE = 1;
const VIEWS = 3;
const DIRECTIONS = 360;
const ROBOT_BYTES = 8 + 2 * DIRECTIONS;
const COLORS: readonly Color[] = ["blue", "yellow"];

/** The message in a binary frame of the connection; null for a picture that cannot be decoded. */
export async function decoded(data: ArrayBuffer): Promise<PictureMessage | ViewsMessage | null> {
  const header = new DataView(data);
  const kind = header.getUint8(0);
  if (kind === VIEWS) return viewsOf(header);
  if (kind !== PICTURE) return null;
  try {
    const bitmap = await createImageBitmap(new Blob([new Uint8Array(data, 16)], { type: "image/jpeg" }));
    return { topic: "picture", number: header.getUint32(4, true), grabbed_s: header.getFloat64(8, true), bitmap };
  } catch {
    return null;
  }
}

export function viewsOf(header: DataView): ViewsMessage {
  const count = header.getUint32(4, true);
  const views: View[] = [];
  for (let index = 0; index < count; index += 1) {
    const start = 16 + index * ROBOT_BYTES;
    const bytes = (from: number) => new Uint8Array(header.buffer, header.byteOffset + start + from, DIRECTIONS);
    views.push({
      team: COLORS[header.getUint8(start)] ?? "blue",
      number: header.getUint8(start + 1),
      ball_px: header.getInt16(start + 2, true),
      ball_direction_deg: header.getInt16(start + 4, true),
      ball_size_deg: header.getInt16(start + 6, true),
      kinds: bytes(8),
      px: bytes(8 + DIRECTIONS),
    });
  }
  return { topic: "views", grabbed_s: header.getFloat64(8, true), views };
}

interface Timed<T> {
  value: T;
  age_s: number;
  valid: boolean;
}

export interface SightingsMessage {
  topic: "sightings";
  sightings: Timed<{
    robots: { team: Color; id: number | null; x_px: number; y_px: number; heading_rad: number | null; confidence: number }[];
    balls: { x_px: number; y_px: number; confidence: number }[];
  }> | null;
  outlines_px: [number, number][][];
  obstacles: Timed<{ obstacles: { x_px: number; y_px: number }[] }> | null;
  obstacle_outlines_px: [number, number][][];
}
