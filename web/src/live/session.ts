// Who looks at the page, and what he may do.

import { computed, ref, shallowRef, watch } from "vue";

import { api, ApiError } from "../api/client";
import type { Me } from "../api/types";
import { connection, lostBecause } from "./service";

export const me = shallowRef<Me | null>(null);
export const isOperator = computed(() => me.value?.role === "operator");
/** The page may be read; false: viewers have to log in. */
export const mayLook = ref(true);

watch(lostBecause, (reason) => {
  if (reason && me.value) void loadMe(); // it may be that the session has ended
});

export async function loadMe(): Promise<void> {
  try {
    me.value = await api.get<Me>("/me");
    mayLook.value = true;
  } catch (error) {
    if (error instanceof ApiError && error.status === 0) return; // the service is away, which ends no login
    me.value = null;
    mayLook.value = !(error instanceof ApiError && error.status === 401);
  }
}

// The service ends the connection of whose login has ended, and says so: what he may do is asked again.
watch(lostBecause, (reason) => {
  if (reason && me.value) void loadMe();
});

export async function logIn(secret: string): Promise<void> {
  me.value = await api.post<Me>("/login", { secret });
  mayLook.value = true;
  connection.restart();
}

export async function logOut(): Promise<void> {
  await api.post("/logout");
  await loadMe();
  connection.restart();
}
