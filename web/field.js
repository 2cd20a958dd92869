// The field from above, and what the chosen robot sees of it.

import { bytesFrom, cleared, color, edgeLook, outlinedText, robotLabel, runsOf } from "./drawing.js";

const PADDING_M = 0.06;
const FRONT_RAD = 0.9; // half the angle of an SSL robot's flat front
const RAY_EVERY_DEG = 10;
const MIN_LABELLED_PX = 11;
const HEADING_KNOWN_RAD = 1; // a standard deviation above it is that of a heading never read
const THINNEST_BAND_PX = 2.5;
const MIN_BODY_PX = 4;
const MIN_TARGET_PX = 14;
const BAR = { ahead: 0.8, half: 0.6, wide: 0.2 }; // of a square's half side: the mark at its front

/** Where the world is on a canvas: {scale, at(x, y)}. */
export function mapping(field, width, height) {
  const ends = field.segments.flatMap((s) => [[s.x1_m, s.y1_m], [s.x2_m, s.y2_m]]);
  const halfX = Math.max(field.length_m / 2, ...ends.map(([x]) => Math.abs(x))) + PADDING_M;
  const halfY = Math.max(field.width_m / 2, ...ends.map(([, y]) => Math.abs(y))) + PADDING_M;
  const scale = Math.min(width / (2 * halfX), height / (2 * halfY));
  return { scale, at: (x, y) => [width / 2 + x * scale, height / 2 - y * scale] };
}

/** Draw the field; chosen is {team, number} or null. */
export function drawField(canvas, field, state, chosen) {
  const { pen, width, height } = cleared(canvas);
  const map = mapping(field, width, height);
  const world = state.world?.valid ? state.world.value : null;
  const view = chosen && state.views?.valid
    ? state.views.value.views.find((v) => v.team === chosen.team && v.number === chosen.number) : null;
  const own = chosen && world?.robots.find((r) => r.team === chosen.team && r.id === field.marker_ids[chosen.team][chosen.number - 1]);
  const seen = view && own ? seenBand(field, view, own, THINNEST_BAND_PX / map.scale) : null;
  if (seen) drawSeenArea(pen, map, seen, own);
  drawPaint(pen, map, field);
  drawSegments(pen, map, field);
  if (seen) drawSeenEdges(pen, map, field, seen);
  for (const obstacle of world?.obstacles ?? []) drawObstacle(pen, map, obstacle);
  for (const robot of world?.robots ?? []) drawRobot(pen, map, field, robot, robot === own, world.at);
  if (world?.ball) drawBall(pen, map, field, world.ball);
}

/** The robot under a point of the canvas: {team, id, number}, number 0 for one without; or null. */
export function robotAt(canvas, field, state, x, y) {
  const map = mapping(field, canvas.clientWidth, canvas.clientHeight);
  const robot = nearestWithin(map, state.world?.value.robots, (robot) => field.robots[robot.team].radius_m, x, y);
  return robot && { team: robot.team, id: robot.id, number: field.marker_ids[robot.team].indexOf(robot.id) + 1 };
}

/** The obstacle under a point of the canvas, as the world has it; or null. */
export function obstacleAt(canvas, field, state, x, y) {
  const map = mapping(field, canvas.clientWidth, canvas.clientHeight);
  return nearestWithin(map, state.world?.value.obstacles, (obstacle) => obstacle.radius_m, x, y);
}

/** The thing whose center is nearest to a point of the canvas, of those that hold it; or null. */
function nearestWithin(map, things, radiusOf, x, y) {
  let [found, nearest] = [null, Infinity];
  for (const thing of things ?? []) {
    const [tx, ty] = map.at(thing.x_m, thing.y_m);
    const away = Math.hypot(x - tx, y - ty);
    if (away < nearest && away <= Math.max(radiusOf(thing) * map.scale, MIN_TARGET_PX)) [found, nearest] = [thing, away];
  }
  return found;
}

/** A view on the floor: per direction the near and the far end of what the edge's pixel of the mirror spans. */
function seenBand(field, view, own, thinnest_m) {
  const horizon = 2 * Math.hypot(field.length_m, field.width_m);
  const metres = (px) => field.mirror_m[px] ?? horizon;
  const reachOf = (px) => metres(Math.floor(px)) + (px % 1) * (metres(Math.floor(px) + 1) - metres(Math.floor(px)));
  const on = (reach, direction) => {
    const angle = own.heading_rad + (direction * Math.PI) / 180;
    return [own.x_m + reach * Math.cos(angle), own.y_m + reach * Math.sin(angle)];
  };
  const runs = runsOf(bytesFrom(view.kinds));
  const middles = evened(bytesFrom(view.px), runs);
  const near = middles.map((px) => reachOf(px - 0.5));
  const far = middles.map((px, direction) => Math.max(reachOf(px + 0.5), near[direction] + thinnest_m));
  return { near: near.map(on), far: far.map(on), runs };
}

/** Pixels without their steps: where an edge passes from one pixel to the next, its distance is known exactly. */
function evened(px, runs) {
  const even = new Array(px.length);
  for (const { start, length } of runs) {
    const at = (step) => px[(start + step) % px.length];
    const border = (step) => (at(Math.max(step - 1, 0)) + at(Math.min(step, length - 1)) + 1) / 2;
    for (let first = 0, end = 0; first < length; first = end) {
      while (end < length && at(end) === at(first)) end += 1;
      const [from, to] = [border(first), border(end)];
      for (let step = first; step < end; step += 1) even[(start + step) % px.length] = from + ((to - from) * (step - first + 0.5)) / (end - first);
    }
  }
  return even;
}

function drawSeenArea(pen, map, seen, own) {
  pen.beginPath();
  for (const [x, y] of seen.near) pen.lineTo(...map.at(x, y));
  pen.closePath();
  pen.fillStyle = "#ffffff2e";
  pen.fill();
  pen.strokeStyle = "#ffffff40";
  pen.lineWidth = 1;
  pen.beginPath();
  for (let direction = 0; direction < seen.near.length; direction += RAY_EVERY_DEG) {
    pen.moveTo(...map.at(own.x_m, own.y_m));
    pen.lineTo(...map.at(...seen.near[direction]));
  }
  pen.stroke();
}

function drawSeenEdges(pen, map, field, seen) {
  const count = seen.near.length;
  for (const { code, start, length } of seen.runs) {
    if (code === field.edge_types.nothing.code) continue;
    const look = edgeLook(field, code);
    pen.beginPath();
    for (let step = 0; step < length; step += 1) pen.lineTo(...map.at(...seen.near[(start + step) % count]));
    for (let step = length - 1; step >= 0; step -= 1) pen.lineTo(...map.at(...seen.far[(start + step) % count]));
    pen.closePath();
    pen.globalAlpha = code === field.edge_types.wall.code ? 0.22 : 0.6;
    pen.fillStyle = code === field.edge_types.wall.code ? "#ffffff" : look.color;
    pen.fill();
  }
  pen.globalAlpha = 1;
}

function drawPaint(pen, map, field) {
  pen.strokeStyle = color("carpet-line");
  pen.lineWidth = Math.max(field.line_width_m * map.scale, 1);
  pen.beginPath();
  for (const [x1, y1, x2, y2] of field.lines) {
    pen.moveTo(...map.at(x1, y1));
    pen.lineTo(...map.at(x2, y2));
  }
  for (const arc of field.arcs) {
    const [x, y] = map.at(arc.x_m, arc.y_m);
    pen.moveTo(x + arc.radius_m * map.scale * Math.cos(arc.start_rad), y - arc.radius_m * map.scale * Math.sin(arc.start_rad));
    pen.arc(x, y, arc.radius_m * map.scale, -arc.start_rad, -arc.end_rad, true);
  }
  pen.stroke();
}

function drawSegments(pen, map, field) {
  for (const segment of field.segments) {
    pen.strokeStyle = segment.kind === field.edge_types.wall.code ? "#11181499" : edgeLook(field, segment.kind).color;
    pen.lineWidth = segment.solid ? 4 : 1.5;
    pen.setLineDash(segment.solid ? [] : [6, 5]);
    pen.beginPath();
    pen.moveTo(...map.at(segment.x1_m, segment.y1_m));
    pen.lineTo(...map.at(segment.x2_m, segment.y2_m));
    pen.stroke();
  }
  pen.setLineDash([]);
}

function drawRobot(pen, map, field, robot, isChosen, at) {
  const [x, y] = map.at(robot.x_m, robot.y_m);
  const body = field.robots[robot.team];
  const radius = Math.max(body.radius_m * map.scale, MIN_BODY_PX);
  const front = -robot.heading_rad;
  const headed = robot.heading_sd_rad <= HEADING_KNOWN_RAD;
  const square = headed && body.outline === "square";
  const blue = robot.team === "blue";
  const predicted = robot.seen < at;
  const on = (ahead, aside) => [x + radius * (ahead * Math.cos(front) - aside * Math.sin(front)), y + radius * (ahead * Math.sin(front) + aside * Math.cos(front))];
  pen.beginPath();
  if (square) for (const corner of [[1, 1], [-1, 1], [-1, -1], [1, -1]]) pen.lineTo(...on(...corner));
  else if (headed) pen.arc(x, y, radius, front + FRONT_RAD, front - FRONT_RAD);
  else pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.closePath();
  pen.globalAlpha = predicted ? 0.6 : 1;
  pen.fillStyle = blue ? "#2f6fe4" : "#ffd23f";
  pen.fill();
  pen.globalAlpha = 1;
  pen.setLineDash(predicted ? [3, 3] : []);
  pen.lineWidth = isChosen ? 3 : 1.2;
  pen.strokeStyle = isChosen ? "#ffffff" : "#0b120e";
  pen.stroke();
  pen.setLineDash([]);
  if (square) {
    pen.beginPath();
    pen.moveTo(...on(BAR.ahead, -BAR.half));
    pen.lineTo(...on(BAR.ahead, BAR.half));
    pen.lineWidth = BAR.wide * radius;
    pen.strokeStyle = blue ? "#ffffff" : "#2a2000";
    pen.stroke();
  }
  pen.textAlign = "center";
  const label = robot.id === null ? "?" : robotLabel(field, robot.team, robot.id);
  if (radius >= MIN_LABELLED_PX) {
    pen.font = "700 11px system-ui, sans-serif";
    pen.fillStyle = blue ? "#ffffff" : "#2a2000";
    pen.textBaseline = "middle";
    const back = square ? BAR.wide * radius : 1.5;
    pen.fillText(label, x - back * Math.cos(front), y - back * Math.sin(front) + 0.5);
    pen.textBaseline = "alphabetic";
  } else {
    pen.font = "600 10px system-ui, sans-serif";
    outlinedText(pen, label, x, y - radius - 4, blue ? "#a8c8ff" : "#ffe58a");
  }
}

function drawObstacle(pen, map, obstacle) {
  const [x, y] = map.at(obstacle.x_m, obstacle.y_m);
  const radius = Math.max(obstacle.radius_m * map.scale, MIN_BODY_PX);
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = color("unknown-body");
  pen.fill();
  pen.lineWidth = 1.2;
  pen.strokeStyle = "#ffffff";
  pen.stroke();
  pen.textAlign = "center";
  pen.font = "700 11px system-ui, sans-serif";
  if (radius < MIN_LABELLED_PX) return outlinedText(pen, "?", x, y - radius - 4, "#ffffff");
  pen.fillStyle = "#ffffff";
  pen.textBaseline = "middle";
  pen.fillText("?", x, y + 0.5);
  pen.textBaseline = "alphabetic";
}

function drawBall(pen, map, field, ball) {
  const [x, y] = map.at(ball.x_m, ball.y_m);
  pen.beginPath();
  pen.arc(x, y, Math.max(field.ball_radius_m * map.scale, 4.5), 0, 2 * Math.PI);
  pen.fillStyle = ball.hidden ? "#ff6a2a60" : "#ff6a2a";
  pen.fill();
  pen.setLineDash(ball.hidden ? [2, 2] : []);
  pen.lineWidth = 1.5;
  pen.strokeStyle = "#ffffff";
  pen.stroke();
  pen.setLineDash([]);
}
