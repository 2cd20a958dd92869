// The numbers of a simulated game, as people read them.

import type { Game } from "../api/types";

/** Blue's share of the time in which some team possessed the ball [%]; an even 50 before anybody touched it. */
export function share(game: Game): number {
  const both = game.blue.possession_s + game.yellow.possession_s;
  return both ? Math.round((100 * game.blue.possession_s) / both) : 50;
}

export function perMinute(game: Game): number {
  return game.played_s ? (60 * game.collisions) / game.played_s : 0;
}

/** 3:07 */
export function clock(played_s: number): string {
  const whole = Math.floor(played_s);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
