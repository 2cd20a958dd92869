// Light or dark: as the system has it, or as chosen for this browser.

import { ref, watch } from "vue";

import { forgetColors } from "../canvas/drawing";

export type Theme = "system" | "light" | "dark";
const KEY = "pslv-theme";

export const theme = ref<Theme>(stored());
watch(theme, apply, { immediate: true });

function stored(): Theme {
  const found = localStorage.getItem(KEY);
  return found === "light" || found === "dark" ? found : "system";
}

function apply(chosen: Theme): void {
  if (chosen === "system") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = chosen;
  localStorage.setItem(KEY, chosen);
  forgetColors();
}
