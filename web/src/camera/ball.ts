// Whether the ball is seen, and where it may be if not, in words.

import type { Camera } from "../api/types";

type Contours = Camera["contours"];
type Robot = NonNullable<Contours>["hiding"][number];

/** "may be hidden behind blue 3", "gone: ..."; of a check that does not run: "not checked yet". */
export function ballWords(contours: Contours): string {
  if (!contours) return "not checked yet";
  if (contours.ball === "may be hidden") return `may be hidden behind ${named(contours.hiding)}`;
  if (contours.ball !== "gone") return contours.ball === "unknown" ? "not seen yet" : contours.ball;
  const last = "gone: nothing covers the place where it was last";
  return contours.can_hide_ball.length ? `${last}; it may be behind ${named(contours.can_hide_ball)}` : last;
}

function named(robots: readonly Robot[]): string {
  return robots.map(({ team, id }) => (id === null ? `a ${team} robot` : `${team} marker ${id}`)).join(", ");
}
