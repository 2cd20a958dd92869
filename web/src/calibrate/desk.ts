// The calibration that the service keeps: pictures, the job that runs, and what it found.

import { computed, onMounted, onUnmounted, ref, shallowRef } from "vue";

import { api } from "../api/client";
import type { Calibration, CalibrationPicture } from "../api/types";
import { refuse } from "../widgets/changes";
import { upload } from "../widgets/upload";

const BASE = "/calibration";
const POLL_MS = 250;

/** The calibration and everything that one can do with it. */
export function useCalibration() {
  const calibration = shallowRef<Calibration | null>(null);
  const heightError = ref("");
  let timer = 0;

  function show(now: Calibration): void {
    calibration.value = now;
    clearTimeout(timer);
    if (now.state === "running") timer = window.setTimeout(() => void load(), POLL_MS);
  }

  /** Show what a request answers with; false when it was refused. */
  async function run(request: Promise<Calibration>): Promise<boolean> {
    try {
      show(await request);
      return true;
    } catch (error) {
      refuse(error, (field, words) => (field.startsWith("height") ? ((heightError.value = words), true) : false));
      return false;
    }
  }

  const load = () => run(api.get<Calibration>(BASE));
  const take = (of: string) => run(api.post<Calibration>(`${BASE}/pictures/camera?of=${of}`));
  const remove = (path: string) => run(api.delete<Calibration>(`${BASE}${path}`));
  const send = (of: string, files: readonly File[], progress: (words: string) => void) => upload<Calibration>(`${BASE}/pictures?of=${of}&name=`, files, show, progress);
  function start(path: string, body: unknown = {}): Promise<boolean> {
    heightError.value = "";
    return run(api.post<Calibration>(`${BASE}${path}`, body));
  }

  onMounted(() => void load());
  onUnmounted(() => clearTimeout(timer));
  const isRunning = computed(() => calibration.value?.state === "running");
  return { calibration, heightError, isRunning, show, load, take, remove, send, start };
}

export type CalibrationDesk = ReturnType<typeof useCalibration>;

/** The address of a picture. */
export function imageHref(picture: CalibrationPicture, small = false): string {
  return `/api/v1${BASE}/pictures/${picture.number}.jpg?small=${small}`;
}

/** What a picture that is compared with the others, or shows a board, has beside its name. */
export function remarksOf(now: Calibration | null): { field: Record<string, string>; board: Record<string, string> } {
  const field = (now?.result?.pictures ?? []).map((one) => [one.name, one.apart_px === null ? "hardly any lines are seen" : `${one.sections} pieces of lines, ${one.apart_px.toFixed(2)} px from the others`]);
  const board = (now?.lens?.pictures ?? []).map((one) => [one.name, one.unseen || `${one.corners.length} corners of ${one.paper}${one.rms_px === null ? "" : `, ${one.rms_px.toFixed(2)} px, tilted by ${one.tilt_deg?.toFixed(0)}°`}`]);
  return { field: Object.fromEntries(field), board: Object.fromEntries(board) };
}
