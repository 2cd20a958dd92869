// A mirror that somebody thinks of: for whom it is, what the server says of it, and taking it over.

import { computed, onUnmounted, ref, shallowRef, watch, type ShallowRef } from "vue";

import { api, ApiError } from "../api/client";
import type { Change, MirrorInForce, MirrorPreview, Mirrors, Robot } from "../api/types";
import { revision } from "../live/service";
import { complain } from "../widgets/toasts";
import { make } from "../widgets/changes";
import type { Constants } from "./equation";

export type Name = keyof Constants;
export const NAMES: readonly Name[] = ["a", "b", "c"];
const ASK_AFTER_MS = 120; // while a slider moves, the server is not asked at each step

/** "field", "blue" or "blue 3" as a path of the API. */
export const pathOf = (scope: string) => `/mirrors/${scope.replace(" ", "/")}`;
export const scopeOf = ({ team, number }: Robot) => `${team} ${number}`;

function queryOf(scope: string): string {
  const [color, number] = scope.split(" ");
  return scope === "field" ? "" : `?color=${color}${number ? `&number=${number}` : ""}`;
}

export function useProposal(mirrors: ShallowRef<Mirrors | null>) {
  const scope = ref("field");
  const proposed = shallowRef<Constants | null>(null);
  const moved = ref<Name | null>(null);
  const preview = shallowRef<MirrorPreview | null>(null);
  const isAsked = ref(false);
  let timer = 0;

  const current = computed<MirrorInForce | null>(() => mirrors.value?.mirrors.find((one) => one.scope === scope.value) ?? null);
  const shown = computed<Constants | null>(() => proposed.value ?? current.value);
  /** Broken rules at the constant that breaks each: of a rule of all three the one that was moved last. */
  const errors = computed(() => {
    const found: Partial<Record<Name | "all", string>> = {};
    for (const { constant, found: what, accepted } of preview.value?.violations ?? []) found[(constant as Name) || moved.value || "all"] = `${what}; accepted: ${accepted}`;
    return found;
  });
  const isAllowed = computed(() => proposed.value !== null && !isAsked.value && preview.value?.violations.length === 0);

  async function ask(): Promise<void> {
    const [asked, of] = [proposed.value, scope.value];
    if (!asked) return;
    try {
      const answer = await api.post<MirrorPreview>(`/mirrors/preview${queryOf(of)}`, asked);
      if (asked !== proposed.value || of !== scope.value) return;
      preview.value = answer;
      isAsked.value = false;
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      complain(error.message);
    }
  }

  watch([proposed, scope, revision], () => {
    clearTimeout(timer);
    isAsked.value = proposed.value !== null;
    if (!proposed.value) preview.value = null;
    else timer = window.setTimeout(() => void ask(), ASK_AFTER_MS);
  });
  onUnmounted(() => clearTimeout(timer));

  function propose(constants: Constants, by: Name | null = null): void {
    moved.value = by;
    proposed.value = { a: constants.a, b: constants.b, c: constants.c };
  }

  function discard(): void {
    moved.value = proposed.value = null;
  }

  async function accept(): Promise<void> {
    if (proposed.value && (await make(api.put<Change>(pathOf(scope.value), proposed.value), `The mirror of ${scope.value} holds from the next picture on`))) discard();
  }

  const reset = (of: string) => make(api.delete<Change>(pathOf(of)), `The mirror of ${of} is that of the files again`);
  return { scope, proposed, current, shown, errors, isAllowed, propose, discard, accept, reset };
}
