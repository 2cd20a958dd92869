// The camera's picture with what was seen in it.

import { cleared, color, outlinedText, robotLabel } from "./drawing.js";

const BALL_RING_PX = 9;

/** Draw a picture and its overlay; show says which parts: {robots, ball, lines}. */
export function drawPicture(canvas, bitmap, field, camera, state, show) {
  canvas.style.aspectRatio = `${camera.width_px} / ${camera.height_px}`;
  const { pen, width, height } = cleared(canvas);
  const scale = Math.min(width / camera.width_px, height / camera.height_px);
  pen.translate((width - camera.width_px * scale) / 2, (height - camera.height_px * scale) / 2);
  pen.drawImage(bitmap, 0, 0, camera.width_px * scale, camera.height_px * scale);
  pen.font = "600 11px system-ui, sans-serif";
  pen.textAlign = "center";
  if (show.lines) drawLines(pen, field.painted_px, scale);
  const sightings = state.sightings?.valid ? state.sightings.value : null;
  if (!sightings) return;
  if (show.robots) sightings.robots.forEach((robot, index) => drawRobot(pen, field, robot, state.outlines_px[index], scale));
  if (show.ball) sightings.balls.forEach((ball, index) => drawBall(pen, ball, index, scale));
}

function drawLines(pen, lines, scale) {
  pen.strokeStyle = "#5ef0ff";
  pen.lineWidth = 1;
  pen.beginPath();
  for (const line of lines) line.forEach(([x, y], index) => (index ? pen.lineTo(x * scale, y * scale) : pen.moveTo(x * scale, y * scale)));
  pen.stroke();
}

function drawRobot(pen, field, robot, outline, scale) {
  const body = robot.team === "blue" ? "#6cacff" : color("yellow-body");
  pen.strokeStyle = body;
  pen.lineWidth = 2;
  pen.setLineDash(robot.id === null ? [4, 3] : []);
  pen.beginPath();
  outline.forEach(([x, y]) => pen.lineTo(x * scale, y * scale));
  pen.closePath();
  if (robot.heading_rad !== null) {
    pen.moveTo(robot.x_px * scale, robot.y_px * scale);
    pen.lineTo(outline[0][0] * scale, outline[0][1] * scale);
  }
  pen.stroke();
  pen.setLineDash([]);
  const top = Math.min(...outline.map(([, y]) => y)) * scale;
  const label = `${robotLabel(field, robot.team, robot.id)} ${Math.round(robot.confidence * 100)}%`;
  outlinedText(pen, label, robot.x_px * scale, top - 4, body);
}

function drawBall(pen, ball, index, scale) {
  const [x, y] = [ball.x_px * scale, ball.y_px * scale];
  pen.strokeStyle = index ? "#ffffff90" : color("ball"); // the best one first, the others are candidates
  pen.lineWidth = 2;
  pen.beginPath();
  pen.arc(x, y, BALL_RING_PX, 0, 2 * Math.PI);
  pen.stroke();
  const label = index ? `${Math.round(ball.confidence * 100)}%` : `ball ${Math.round(ball.confidence * 100)}%`;
  outlinedText(pen, label, x, y - BALL_RING_PX - 4, index ? "#ffffff" : "#ffb48a");
}
