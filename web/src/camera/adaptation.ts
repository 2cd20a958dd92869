// What light and colors became since the set-up, in words.

import type { Adaptation } from "../api/types";
import { counted, fixed } from "../canvas/words";

type Change = Adaptation["changes"][number];
type Levels = readonly [number, number, number];

/** Three numbers of blue, green and red. */
export function levels(values: Levels, digits = 2): string {
  return values.map((value) => fixed(value, digits)).join(", ");
}

/** What is in force, in one line. */
export function state(now: Adaptation): string {
  if (now.held) return "Held as set up: nothing is adapted.";
  if (now.as_set_up) return "As set up.";
  const parts = [];
  if (now.light.gain_bgr.join() !== now.light.set_up_gain_bgr.join()) parts.push("other gains");
  if (now.paints.length) parts.push("a palette that was learned");
  return `Adapted to another light: ${parts.join(" and ")}.`;
}

/** One change of the log. */
export function changeWords({ what, gain_bgr, robots, read }: Change): string {
  const papers = `${read} of ${counted(robots, "robot")} read`;
  const words: Record<string, string> = {
    light: `light: gains ${levels(gain_bgr)}`,
    learned: `palette learned from the robots that were read: ${papers}`,
    found: `palette found anew: ${papers}`,
    start: "palette of the set-up again",
    held: "back to the set-up, which is held",
    resumed: "adapted again",
  };
  return words[what] ?? what;
}

/** How far a paint is from where it was set up, in the coordinate that moved more. */
export function shift({ set_up, now }: Adaptation["paints"][number]): number {
  return Math.max(Math.abs(now[0] - set_up[0]), Math.abs(now[1] - set_up[1]));
}
