// What is drawn over the picture; remembered for the browser.

import { reactive, watch } from "vue";

const KEY = "pslv-camera-layers";

export interface Layers {
  robots: boolean;
  obstacles: boolean;
  rejected: boolean;
  blobs: boolean;
  classes: boolean;
  lines: boolean;
  boundary: boolean;
  contours: boolean;
  masks: boolean;
}

export const WORDS: Record<keyof Layers, [label: string, title: string]> = {
  robots: ["robots and ball", "What is found in the newest picture"],
  obstacles: ["obstacles", "Things of robot size that are no known robot and no ball"],
  rejected: ["rejected", "What could be a robot or the ball, and which gate stopped it"],
  blobs: ["blobs", "Connected pixels of one color class"],
  classes: ["color classes", "The color class of every pixel"],
  lines: ["lines", "The painted lines where the camera model has them: solid where the paint is there, dashed where it is not"],
  boundary: ["end of the carpet", "Where the carpet ends in the picture"],
  contours: ["contours", "What the robots cover of the floor: thick where a ball behind the robot may not be seen"],
  masks: ["masks", "Where nothing is looked for"],
};

export const layers = reactive<Layers>(stored());
watch(layers, () => localStorage.setItem(KEY, JSON.stringify(layers)));

function stored(): Layers {
  const found: Layers = { robots: true, obstacles: true, rejected: false, blobs: false, classes: false, lines: false, boundary: false, contours: false, masks: true };
  try {
    const kept = JSON.parse(localStorage.getItem(KEY) ?? "{}") as Partial<Record<string, unknown>>;
    for (const key of Object.keys(found) as (keyof Layers)[]) if (typeof kept[key] === "boolean") found[key] = kept[key];
  } catch {
    localStorage.removeItem(KEY);
  }
  return found;
}
