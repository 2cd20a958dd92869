// Draw again when an element has another size.

import { onMounted, onUnmounted, type Ref } from "vue";

/** Call a function when the element is there, and whenever its size has changed. */
export function whenResized(element: Readonly<Ref<HTMLElement | null>>, changed: () => void): void {
  let observer: ResizeObserver;
  onMounted(() => {
    observer = new ResizeObserver(changed);
    observer.observe(element.value!);
  });
  onUnmounted(() => observer.disconnect());
}
