// Who looks at the page, and what he may do.

import { computed, ref, shallowRef } from "vue";

import { api, ApiError } from "../api/client";
import type { Me } from "../api/types";
import { connection } from "./service";

export const me = shallowRef<Me | null>(null);
export const isOperator = computed(() => me.value?.role === "operator");
/** The page may be read; false: viewers have to log in. */
export const mayLook = ref(true);

export async function loadMe(): Promise<void> {
  try {
    me.value = await api.get<Me>("/me");
    mayLook.value = true;
  } catch (error) {
    me.value = null;
    mayLook.value = !(error instanceof ApiError && error.status === 401);
  }
}

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
