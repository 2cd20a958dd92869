// Changes of the service: made, told with an undo, refused with the reason.

import { api, ApiError } from "../api/client";
import type { Change } from "../api/types";
import { complain, say } from "./toasts";

const MAX_NAMED = 6; // more settings are counted

/** Make a change; returns it, or null when it was refused: onField(field, words) takes what a form is to show. */
export async function make(
  request: Promise<Change>,
  words: string,
  onField?: (field: string, words: string) => boolean,
): Promise<Change | null> {
  try {
    const change = await request;
    const waits = change.needs_restart ?? [];
    const named = waits.length > MAX_NAMED ? `${waits.length} settings` : waits.join(", ");
    const later = waits.length ? ` It takes effect with the next start of the service: ${named}.` : "";
    if (!change.entries.length) say(`${words}: nothing differs from before.`);
    else say(`${words}.${later}`, { label: "Undo", run: () => void undo(change.revision) });
    return change;
  } catch (error) {
    refuse(error, onField);
    return null;
  }
}

export async function undo(revision: number): Promise<void> {
  await step("undo", revision);
}

export async function redo(revision: number): Promise<void> {
  await step("redo", revision);
}

async function step(kind: "undo" | "redo", revision: number): Promise<void> {
  try {
    const change = await api.post<Change>(`/settings/${kind}`, { revision });
    const back = kind === "undo" ? "redo" : "undo";
    say(change.what, { label: back === "redo" ? "Redo" : "Undo", run: () => void step(back, change.revision) });
  } catch (error) {
    refuse(error);
  }
}

/** Say why a request was refused: beside the field of a form where there is one, else as a message. */
export function refuse(error: unknown, onField?: (field: string, words: string) => boolean): void {
  if (!(error instanceof ApiError)) throw error;
  const { found, accepted } = error.problem;
  const words = accepted ? `${found ?? "not accepted"}; accepted: ${accepted}` : error.message;
  if (error.field && onField?.(error.field, words)) return;
  complain(error.message);
}
