// The steps of setting up a venue, and which of them are done.

import type { NewVenue } from "../api/types";

export const STEPS = {
  pictures: "Pictures",
  markers: "Markers",
  field: "Field",
  camera: "Camera",
  colors: "Colors",
  trial: "Try it",
  save: "Save",
} as const;
export type Step = keyof typeof STEPS;
export const ORDER = Object.keys(STEPS) as Step[];

/** What a step still needs; empty: it is done. */
export function missing(step: Step, venue: NewVenue): string {
  switch (step) {
    case "pictures":
      return venue.pictures.length ? "" : "a picture of the field";
    case "field":
      return venue.field ? "" : "the field's measures";
    case "camera":
      return venue.camera ? "" : "a camera that was calibrated and taken";
    case "markers":
      return venue.pattern ? "" : "the robots' markers";
    case "colors":
      return !venue.pattern ? "the robots' markers first" : venue.missing_colors.length ? `samples of ${venue.missing_colors.join(", ")}` : "";
    case "trial":
      return venue.trial?.is_current ? "" : "a look at what is seen";
    case "save":
      return venue.is_saved ? "" : "a name, and to be saved";
  }
}

/** The first step that is not done. */
export function nextOf(venue: NewVenue): Step {
  return ORDER.find((step) => missing(step, venue)) ?? "save";
}

const SEEN: readonly Step[] = ["pictures", "markers", "field", "camera"];
const WHOLE: readonly Step[] = [...SEEN, "colors"];

/** What has to be done before a step makes sense; empty: nothing. */
export function blocked(step: Step, venue: NewVenue): string {
  const needed: Record<Step, readonly Step[]> = { pictures: [], markers: [], field: ["pictures"], camera: ["pictures", "field"], colors: SEEN, trial: WHOLE, save: WHOLE };
  const first = needed[step].find((one) => missing(one, venue));
  return first ? `First: ${missing(first, venue)}.` : "";
}
