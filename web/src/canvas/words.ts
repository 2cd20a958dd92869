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

/** A time of day: 17:05:12; of another day with its date. */
export function clockTime(seconds: number): string {
  const at = new Date(seconds * 1000);
  const time = at.toLocaleTimeString(undefined, { hour12: false });
  return at.toDateString() === new Date().toDateString() ? time : `${at.toLocaleDateString()} ${time}`;
}

/** A value of a setting as text. */
export function valueText(value: unknown): string {
  if (value === null || value === undefined) return "–";
  return typeof value === "string" ? value : JSON.stringify(value);
}
