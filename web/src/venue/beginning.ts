// How the camera is best found at first, by what is known of the field.
import type { NewVenue } from "../api/types";

export type Beginning = "find" | "corners" | "walls";
/** Lines thinner than this, on the feet of walls, are measures: nobody paints them. */
const THIN_M = 0.005;
const MAX_WALL_GAP_M = 0.02;

/** "walls" where no touch lines are painted, "corners" where no search succeeded, else "find". */
export function firstBeginning({ field, fields, preset }: Pick<NewVenue, "field" | "fields" | "preset">): Beginning {
  if (fields?.some((one) => one.is_accepted && one.preset === preset)) return "find";
  const isBare = !field?.line_width_m || (field.walls && field.margin_m <= MAX_WALL_GAP_M && field.line_width_m < THIN_M);
  if (isBare) return "walls";
  return fields?.every((one) => !one.is_accepted) ? "corners" : "find";
}
