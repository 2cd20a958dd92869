// The camera's picture with what was seen in it.

import { cleared, color, freeBox, outlinedText, robotLabel } from "./drawing.js";

const BALL_RING_PX = 9;
const LABEL_HIGH_PX = 13;
const OBSTACLE_COLOR = "#f0a0f0"; // brighter than elsewhere: pictures are dark

/** Draw a picture and its overlay; show says which parts: {robots, ball, obstacles, lines}; chosen is {team, number} or null. */
export function drawPicture(canvas, bitmap, field, camera, state, show, chosen) {
  const { pen, width, height } = cleared(canvas);
  const scale = Math.min(width / camera.width_px, height / camera.height_px);
  pen.translate((width - camera.width_px * scale) / 2, (height - camera.height_px * scale) / 2);
  pen.drawImage(bitmap, 0, 0, camera.width_px * scale, camera.height_px * scale);
  pen.font = "600 11px system-ui, sans-serif";
  pen.textAlign = "center";
  if (show.lines) drawLines(pen, field.painted_px, scale);
  const sightings = state.sightings?.valid ? state.sightings.value : null;
  if (!sightings) return;
  const isChosen = (robot) => chosen !== null && robot.team === chosen.team && robot.id === field.marker_ids[chosen.team][chosen.number - 1];
  const labels = [];
  if (show.robots) sightings.robots.forEach((robot, index) => labels.push(drawRobot(pen, field, robot, state.outlines_px[index], scale, isChosen(robot))));
  if (show.obstacles && state.obstacles?.valid) state.obstacles.value.obstacles.forEach((thing, index) => labels.push(drawObstacle(pen, thing, state.obstacle_outlines_px[index], scale)));
  if (show.ball) sightings.balls.forEach((ball, index) => labels.push(drawBall(pen, ball, index, scale)));
  writeLabels(pen, labels, camera.width_px * scale, camera.height_px * scale);
}

function drawLines(pen, lines, scale) {
  pen.strokeStyle = "#5ef0ff";
  pen.lineWidth = 1;
  pen.beginPath();
  for (const line of lines) line.forEach(([x, y], index) => (index ? pen.lineTo(x * scale, y * scale) : pen.moveTo(x * scale, y * scale)));
  pen.stroke();
}

/** Draw a robot; returns its label. */
function drawRobot(pen, field, robot, outline, scale, isChosen) {
  const body = robot.team === "blue" ? "#6cacff" : color("yellow-body");
  pen.strokeStyle = body;
  pen.lineWidth = isChosen ? 3 : 2;
  pen.setLineDash(robot.id === null ? [4, 3] : []);
  traceOutline(pen, outline, scale);
  if (robot.heading_rad !== null) {
    pen.moveTo(robot.x_px * scale, robot.y_px * scale);
    pen.lineTo(outline[0][0] * scale, outline[0][1] * scale);
  }
  pen.stroke();
  pen.setLineDash([]);
  const name = robotLabel(field, robot.team, robot.id);
  return {
    text: isChosen ? `${name}, confidence ${Math.round(robot.confidence * 100)}%` : name,
    x: robot.x_px * scale,
    y: robot.y_px * scale,
    reach: reachOf(outline, robot) * scale,
    fill: body,
    rank: isChosen ? 0 : robot.id === null ? 3 : 2,
  };
}

/** Draw a thing that nobody knows; returns its label. */
function drawObstacle(pen, thing, outline, scale) {
  pen.strokeStyle = OBSTACLE_COLOR;
  pen.lineWidth = 2;
  traceOutline(pen, outline, scale);
  pen.stroke();
  return { text: "?", x: thing.x_px * scale, y: thing.y_px * scale, reach: reachOf(outline, thing) * scale, fill: OBSTACLE_COLOR, rank: 3 };
}

function traceOutline(pen, outline, scale) {
  pen.beginPath();
  outline.forEach(([x, y]) => pen.lineTo(x * scale, y * scale));
  pen.closePath();
}

/** How far an outline is from a thing's center at most [px of the picture]. */
function reachOf(outline, { x_px, y_px }) {
  return Math.max(...outline.map(([x, y]) => Math.hypot(x - x_px, y - y_px)));
}

/** Draw a ball; returns its label. */
function drawBall(pen, ball, index, scale) {
  const [x, y] = [ball.x_px * scale, ball.y_px * scale];
  pen.strokeStyle = index ? "#ffffff90" : color("ball"); // the best one first, the others are candidates
  pen.lineWidth = 2;
  pen.beginPath();
  pen.arc(x, y, BALL_RING_PX, 0, 2 * Math.PI);
  pen.stroke();
  return { text: index ? "ball?" : "ball", x, y, reach: BALL_RING_PX, fill: index ? "#ffffff" : "#ffb48a", rank: index ? 4 : 1 };
}

/** Each label above its thing, else below, right or left of it; the least important is left out where none is free. */
function writeLabels(pen, labels, width, height) {
  const taken = [];
  for (const { text, x, y, reach, fill } of labels.sort((one, other) => one.rank - other.rank)) {
    const wide = pen.measureText(text).width + 4;
    const high = LABEL_HIGH_PX;
    const [left, top] = [x - wide / 2, y - high / 2];
    const places = [[left, y - reach - high], [left, y + reach], [x + reach, top], [x - reach - wide, top]];
    const inside = places.filter(([a, b]) => a >= 0 && b >= 0 && a + wide <= width && b + high <= height);
    const box = freeBox(taken, inside.map((place) => [...place, wide, high]));
    if (box) outlinedText(pen, text, box[0] + wide / 2, box[1] + high - 3, fill);
  }
}
