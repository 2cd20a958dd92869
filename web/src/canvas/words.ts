// Numbers and times in words.

/** 1 robot, 2 robots. */
export function counted(number: number, thing: string): string {
  return `${number} ${thing}${number === 1 ? "" : "s"}`;
}

/** An age: 12 ms, 3.4 s, 2 min. */
export function age(seconds: number | null | undefined): string {
  if (seconds === null || seconds === undefined) return "–";
  if (seconds < 1) return `${Math.max(0, Math.round(seconds * 1000))} ms`;
  if (seconds < 100) return `${seconds.toFixed(1)} s`;
  return duration(seconds);
}

export function duration(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  if (minutes < 1) return `${Math.floor(seconds)} s`;
  return minutes < 60 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

export function fixed(value: number | null | undefined, digits: number): string {
  return value === null || value === undefined ? "–" : value.toFixed(digits);
}

/** Milliseconds with about two significant digits. */
export function milliseconds(value: number | null | undefined): string {
  if (value === null || value === undefined) return "–";
  return value.toFixed(value < 0.995 ? 2 : value < 9.95 ? 1 : 0);
}

/** Of a file or folder its own name only. */
export function shortUri(uri: string): string {
  return uri.startsWith("file:") ? (uri.replace(/\/+$/, "").split(/[:/]/).at(-1) ?? uri) : uri;
}

const two = (number: number) => String(number).padStart(2, "0");

/** A time of day: 17:05:12. */
export function timeOfDay(at: Date): string {
  return `${two(at.getHours())}:${two(at.getMinutes())}:${two(at.getSeconds())}`;
}

/** A day: 2026-07-01. */
export function dayOf(at: Date): string {
  return `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())}`;
}

/** A time, in seconds since 1970: 17:05:12; of another day with its date. */
export function clockTime(seconds: number): string {
  const at = new Date(seconds * 1000);
  return dayOf(at) === dayOf(new Date()) ? timeOfDay(at) : `${dayOf(at)} ${timeOfDay(at)}`;
}

/** The same to the minute. */
export function minuteOfDay(seconds: number): string {
  return clockTime(seconds).slice(0, -3);
}

/** A value of a setting as text. */
export function valueText(value: unknown): string {
  if (value === null || value === undefined) return "–";
  return typeof value === "string" ? value : JSON.stringify(value);
}
