// What the health strip shows: each figure with its state, which is that of the service's alarms about it.

import type { Alarm, Status } from "../api/types";
import { age, fixed, milliseconds } from "../canvas/words";

export type Level = "ok" | "warning" | "error";
export const SIGNS: Readonly<Record<Level, string>> = { ok: "✓", warning: "⚠", error: "✕" };

export interface Figure {
  key: string;
  name: string;
  value: string;
  level: Level;
  /** The state in a word. */
  word: string;
  /** What the figure is, in a sentence. */
  title: string;
}

type About = Alarm["about"];
const WORDS: Readonly<Record<About, Record<Level, string>>> = {
  service: { ok: "ok", warning: "check", error: "down" },
  camera: { ok: "ok", warning: "check", error: "no image" },
  lag: { ok: "ok", warning: "late", error: "none" },
  misses: { ok: "ok", warning: "many", error: "many" },
  drops: { ok: "ok", warning: "many", error: "many" },
  machine: { ok: "ok", warning: "weak", error: "weak" },
};
const TITLES = {
  camera: "Images a second, and how old the newest one is",
  lag: "A: from the image to the last datagram. B: over the network. C: until the robot's program has used it. Medians in milliseconds",
  misses: "How often in the last minute a task skipped an image or took longer than it may",
  drops: "Datagrams in the last minute that the network refused",
  clients: "Robots' programs that are served / that wait for you to admit them or were refused",
  machine: "How punctually this computer wakes the tasks, A is best; and what the operating system grants them",
} as const;

/** The worst level of the alarms about something. */
export function levelOf(alarms: readonly Alarm[], about: About): Level {
  const levels = alarms.filter((alarm) => alarm.about === about).map((alarm) => alarm.level);
  return levels.includes("error") ? "error" : levels.length ? "warning" : "ok";
}

/** Names an alarm, whatever numbers its text contains. */
export function identity(alarm: Alarm): string {
  return `${alarm.level} ${alarm.about} ${`${alarm.text} ${alarm.detail}`.replace(/\d+([.,]\d+)*/g, "#")}`;
}

const total = (counts: Record<string, number>) => Object.values(counts).reduce((sum, count) => sum + count, 0);
const where = (counts: Record<string, number>) => Object.entries(counts).map(([name, count]) => `${name} ${count}`).join(", ");
const ms = (part: { median_ms: number } | null) => milliseconds(part?.median_ms);

/** Every figure of a status, in the order of the strip. */
export function figuresOf(status: Status): Figure[] {
  const { alarms, cameras, lags, losses, selftest } = status;
  const camera = cameras[0];
  const missed = { ...losses.missed };
  for (const [name, count] of Object.entries(losses.overruns)) missed[name] = (missed[name] ?? 0) + count;
  const judged = (about: keyof typeof TITLES & About, name: string, value: string, more = ""): Figure => {
    const level = levelOf(alarms, about);
    return { key: about, name, value, level, word: WORDS[about][level], title: TITLES[about] + (more && `: ${more}`) };
  };
  const waiting = status.waiting.length;
  return [
    judged("camera", "camera", `${fixed(camera?.measured_rate_hz, 1)} Hz · ${age(camera?.age_s)}`),
    judged("lag", "lag A·B·C ms", `${ms(lags.server)} · ${ms(lags.network)} · ${ms(lags.client)}`),
    judged("misses", "misses", String(total(missed)), where(missed)),
    judged("drops", "drops", String(total(losses.dropped)), where(losses.dropped)),
    {
      key: "clients",
      name: "clients",
      value: `${status.clients.length} / ${waiting}`,
      level: waiting ? "warning" : "ok",
      word: waiting ? `${waiting} waiting` : "ok",
      title: TITLES.clients,
    },
    judged("machine", "real-time class", [selftest?.grade ?? "–", selftest?.policy].filter(Boolean).join(" ")),
  ];
}
