// An answer of the API that is asked for again: every few seconds, and whenever somebody has changed something.

import { onMounted, onUnmounted, ref, shallowRef, watch, type Ref, type ShallowRef } from "vue";

import { api, ApiError } from "../api/client";
import { revision } from "../live/service";

export interface Polled<T> {
  value: ShallowRef<T | null>;
  error: Ref<string>;
  reload: () => Promise<void>;
}

export function usePolled<T>(path: string, every_ms = 0): Polled<T> {
  const value = shallowRef<T | null>(null);
  const error = ref("");
  let timer = 0;

  async function reload(): Promise<void> {
    try {
      value.value = await api.get<T>(path);
      error.value = "";
    } catch (failed) {
      if (!(failed instanceof ApiError)) throw failed;
      error.value = failed.message;
    }
  }

  watch(revision, reload);
  onMounted(() => {
    void reload();
    if (every_ms) timer = window.setInterval(() => document.hidden || void reload(), every_ms);
  });
  onUnmounted(() => clearInterval(timer));
  return { value, error, reload };
}
