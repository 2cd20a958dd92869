// The draft of a new venue, which the service keeps: read, changed step by step, followed while a step runs.

import { computed, onMounted, onUnmounted, reactive, shallowRef } from "vue";

import { api, ApiError } from "../api/client";
import type { NewVenue, VenueChoices, VenuePatch } from "../api/types";
import { refuse } from "../widgets/changes";
import { complain } from "../widgets/toasts";
import { upload } from "../widgets/upload";

const BASE = "/new-venue";
const POLL_MS = 300;

/** The draft and everything that one can do with it. */
export function useDraft() {
  const venue = shallowRef<NewVenue | null>(null);
  const choices = shallowRef<VenueChoices | null>(null);
  /** Words beside the fields of the forms, by the fields' names. */
  const errors = reactive<Record<string, string>>({});
  let timer = 0;

  function show(now: NewVenue): void {
    venue.value = now;
    clearTimeout(timer);
    if (now.state === "running") timer = window.setTimeout(() => void run(api.get<NewVenue>(BASE)), POLL_MS);
  }

  /** Show the draft that a request answers with; returns it, or null when it was refused. */
  async function run(request: Promise<NewVenue>): Promise<NewVenue | null> {
    try {
      const now = await request;
      show(now);
      return now;
    } catch (error) {
      refuse(error, (field, words) => {
        errors[field] = words;
        return field in SHOWN;
      });
      return null;
    }
  }

  const forget = () => Object.keys(errors).forEach((field) => delete errors[field]);
  const post = (path: string, body: unknown = {}) => (forget(), run(api.post<NewVenue>(`${BASE}${path}`, body)));
  const remove = (path: string) => run(api.delete<NewVenue>(`${BASE}${path}`));
  const choose = (patch: Partial<VenuePatch>) => (forget(), run(api.patch<NewVenue>(BASE, { ...patch, seen: venue.value?.number ?? null })));

  const send = (files: readonly File[], progress: (words: string) => void) => upload<NewVenue>(`${BASE}/pictures?name=`, files, show, progress);

  async function load(): Promise<void> {
    try {
      const [now, known] = await Promise.all([api.get<NewVenue>(BASE), api.get<VenueChoices>(`${BASE}/choices`)]);
      choices.value = known;
      show(now);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      complain(error.message);
    }
  }

  onMounted(() => void load());
  onUnmounted(() => clearTimeout(timer));
  const isRunning = computed(() => venue.value?.state === "running");
  return { venue, choices, errors, isRunning, run, post, remove, choose, send, load };
}

/** Fields that have a place for words beside them. */
const SHOWN: Record<string, true> = { name: true, height_m: true, preset: true, pattern: true };

export type VenueDraft = ReturnType<typeof useDraft>;

/** The address of a picture of the draft: another picture has another one. */
export function pictureHref(venue: NewVenue, index: number, small = false): string {
  const file = venue.pictures[index]?.file ?? "";
  return `/api/v1${BASE}/pictures/${index}.jpg?small=${small}&file=${encodeURIComponent(file)}`;
}

export const percent = (share: number) => `${Math.round(100 * share)} %`;
export const digits = (value: number | null | undefined, places: number) => value?.toFixed(places) ?? "–";
