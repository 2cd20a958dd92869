// Short messages that go by themselves, with an action such as undo.

import { reactive } from "vue";

export interface Toast {
  id: number;
  text: string;
  kind: "done" | "failed";
  action?: { label: string; run: () => void };
  open: boolean;
}

export const toasts = reactive<Toast[]>([]);
let made = 0;

export function say(text: string, action?: Toast["action"]): void {
  show({ text, kind: "done", action });
}

export function complain(text: string): void {
  show({ text, kind: "failed" });
}

function show(toast: Omit<Toast, "id" | "open">): void {
  while (toasts.length >= 3) toasts.shift();
  toasts.push({ ...toast, id: ++made, open: true });
}

export function dismiss(id: number): void {
  const at = toasts.findIndex((toast) => toast.id === id);
  if (at >= 0) toasts.splice(at, 1);
}
