// The one live connection of the page, and what the whole page knows of the service: link, status, field, clock.

import { computed, onScopeDispose, ref, shallowRef, watch, type ShallowRef } from "vue";

import { api } from "../api/client";
import type { Field, Match, Status } from "../api/types";
import { LiveConnection, type Received } from "./connection";
import type { StatusMessage } from "./messages";

const CLOCK_DRIFT = 1e-4;
export const STALE_S = 0.5;

export const linked = ref(false);
export const lostBecause = ref("");
export const status = shallowRef<Status | null>(null);
export const match = shallowRef<Match | null>(null);
export const revision = ref(0);
export const pages = ref(0);
export const field = shallowRef<Field | null>(null);
/** Seconds of the page's clock, renewed ten times a second, so that ages grow while nothing comes. */
export const pageClock = ref(seconds());

let ahead = -Infinity; // the service's clock minus the page's [s]; a late message can only make it too small
const received = ref(0); // when the newest update came [s of the page's clock]
let fieldOf = -1; // the revision that the field belongs to

export const connection = new LiveConnection(onLink, (now_s) => {
  ahead = Math.max(now_s - seconds(), ahead - CLOCK_DRIFT * (seconds() - received.value));
  received.value = seconds();
});

export function seconds(): number {
  return performance.now() / 1000;
}

/** Time since an instant of the service's clock [s]. */
export function since(instant_s: number): number {
  return Math.max(pageClock.value + (Number.isFinite(ahead) ? ahead : 0) - instant_s, 0);
}

/** Time since the service sent anything [s]: it sends a status four times a second. */
export const silence_s = computed(() => (received.value ? Math.max(pageClock.value - received.value, 0) : 0));

/** Begin; the page calls it once. */
export function startLive(): void {
  setInterval(() => (pageClock.value = seconds()), 100);
  connection.subscribe<StatusMessage>("status", (message) => {
    status.value = message.status;
    match.value = message.match;
    pages.value = message.pages;
    revision.value = message.revision;
    if (message.revision !== fieldOf) void loadField(message.revision);
  });
  connection.start();
}

/** The newest message of a topic while a component is there; null before the first. */
export function useTopic<T extends Received>(topic: string): ShallowRef<T | null> {
  const newest = shallowRef(null) as ShallowRef<T | null>;
  onScopeDispose(connection.subscribe<T>(topic, (message) => (newest.value = message)));
  return newest;
}

/** The newest message of a topic while it is wanted and a component is there; null otherwise. */
export function useTopicWhile<T extends Received>(topic: string, wanted: () => boolean): ShallowRef<T | null> {
  const newest = shallowRef(null) as ShallowRef<T | null>;
  let end: (() => void) | null = null;
  watch(wanted, (isWanted) => {
    end?.();
    newest.value = null;
    end = isWanted ? connection.subscribe<T>(topic, (message) => (newest.value = message)) : null;
  }, { immediate: true });
  onScopeDispose(() => end?.());
  return newest;
}

function onLink(open: boolean, reason: string): void {
  linked.value = open;
  lostBecause.value = reason;
  if (open) {
    ahead = -Infinity;
    fieldOf = -1;
  }
}

/** The field may be another after a change of sides or a start with other settings. */
async function loadField(revision: number): Promise<void> {
  fieldOf = revision;
  try {
    const found = await api.get<Field>("/field");
    if (fieldOf === revision) field.value = found; // an answer that a newer one has overtaken is dropped
  } catch {
    fieldOf = -1; // the next status tries again
  }
}
