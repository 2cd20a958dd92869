// Where robots and ball were in the last seconds.

import type { WorldMessage } from "../live/messages";
import type { FieldMap } from "./map";

const SECONDS = 2;
const EVERY_S = 0.05;

interface Point {
  at_s: number;
  x_m: number;
  y_m: number;
}

export class Trails {
  private readonly lines = new Map<string, Point[]>();
  private last_s = -Infinity;

  /** Note a world; older points fall away. */
  note(world: WorldMessage): void {
    if (!world.valid || world.grabbed_s - this.last_s < EVERY_S) {
      if (world.grabbed_s < this.last_s) this.lines.clear(); // the service has started anew
      else return;
    }
    this.last_s = world.grabbed_s;
    for (const robot of world.robots) {
      if (robot.id !== null) this.add(`${robot.team} ${robot.id}`, world.grabbed_s, robot);
    }
    if (world.ball) this.add("ball", world.grabbed_s, world.ball);
    for (const [name, points] of this.lines) {
      while (points[0] && world.grabbed_s - points[0].at_s > SECONDS) points.shift();
      if (!points.length) this.lines.delete(name);
    }
  }

  draw(pen: CanvasRenderingContext2D, map: FieldMap): void {
    pen.lineWidth = 2;
    pen.lineJoin = "round";
    for (const [name, points] of this.lines) {
      pen.strokeStyle = name === "ball" ? "#ff8a50" : name.startsWith("blue") ? "#9cc2ff" : "#ffe27a";
      pen.globalAlpha = 0.75;
      pen.beginPath();
      for (const { x_m, y_m } of points) pen.lineTo(...map.at(x_m, y_m));
      pen.stroke();
    }
    pen.globalAlpha = 1;
  }

  /** How many points are kept, of all lines. */
  get size(): number {
    return [...this.lines.values()].reduce((sum, points) => sum + points.length, 0);
  }

  private add(name: string, at_s: number, place: { x_m: number; y_m: number }): void {
    const points = this.lines.get(name) ?? [];
    points.push({ at_s, x_m: place.x_m, y_m: place.y_m });
    this.lines.set(name, points);
  }
}
