// Lines of the log: which ones are shown, and how they read.

import type { LogLine } from "../api/types";

export const LEVELS = ["error", "warning", "info"] as const;
export type Level = (typeof LEVELS)[number];

export interface Filter {
  /** This level and worse ones. */
  level: Level;
  /** Empty: every process. */
  process: string;
  /** Words that the line has to contain; empty: any line. */
  words: string;
}

export function chosen(lines: readonly LogLine[], { level, process, words }: Filter): LogLine[] {
  const worst = LEVELS.indexOf(level);
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
  return lines.filter((line) => {
    const text = `${line.process} ${line.text}`.toLowerCase();
    return LEVELS.indexOf(line.level) <= worst && (!process || line.process === process) && wanted.every((word) => text.includes(word));
  });
}

export const processesOf = (lines: readonly LogLine[]): string[] => [...new Set(lines.map((line) => line.process))].sort();

const TIME: Intl.DateTimeFormatOptions = { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" };

/** Time of day of this browser; with the date when that is another day. */
export function timeOf(at: number, now = new Date()): string {
  const then = new Date(at * 1000);
  const time = then.toLocaleTimeString("en-GB", TIME);
  return then.toDateString() === now.toDateString() ? time : `${then.toLocaleDateString("en-CA")} ${time}`;
}

/** "3 lines were left out ..."; empty when none is. */
export function missing({ left_out, older }: { left_out: number; older: number }): string {
  const parts = [];
  if (left_out) parts.push(`${counted(left_out)} left out because a process printed too many at once`);
  if (older) parts.push(`${counted(older)} dropped to make room for newer ones`);
  return parts.join("; ");
}

const counted = (count: number): string => (count === 1 ? "1 line was" : `${count} lines were`);

/** The lines as text, one a line, with the date and time in UTC. */
export function asText(lines: readonly LogLine[]): string {
  return lines.map((line) => `${new Date(line.at * 1000).toISOString()} ${line.level} ${line.process}: ${line.text}${line.times > 1 ? ` (${line.times} times)` : ""}\n`).join("");
}
