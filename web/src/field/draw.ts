// The field from above: paint, walls, coverage of the camera, robots, ball, obstacles, and what one robot sees.

import type { Field, Robot } from "../api/types";
import { cleared, color, edgeLook, numberOf, outlinedText, robotLabel } from "../canvas/drawing";
import type { View, WorldBall, WorldMessage, WorldObstacle, WorldRobot } from "../live/messages";
import { mapping, type FieldMap } from "./map";
import { drawSeenArea, drawSeenEdges, seenBand } from "./seen";
import type { Trails } from "./trails";

const FRONT_RAD = 0.9; // half the angle of an SSL robot's flat front
const MIN_LABELLED_PX = 11;
const HEADING_KNOWN_RAD = 1; // a standard deviation above it is that of a heading never read
const THINNEST_BAND_PX = 2.5;
const MIN_BODY_PX = 4;
const BAR = { ahead: 0.8, half: 0.6, wide: 0.2 }; // of a square's half side: the mark at its front
const SIGMAS = 3; // of the ellipses
const MIN_ELLIPSE_PX = 2;
const PULSE_S = 0.8;

export interface Layers {
  trails: boolean;
  uncertainty: boolean;
  coverage: boolean;
}

export interface Scene {
  field: Field;
  world: WorldMessage | null;
  view: View | null;
  chosen: Robot | null;
  /** A robot that is to be found by people: a ring pulses round it. */
  identified: Robot | null;
  trails: Trails;
  layers: Layers;
  now_s: number;
}

export function drawField(canvas: HTMLCanvasElement, scene: Scene): void {
  const { pen, width, height } = cleared(canvas);
  const { field, chosen } = scene;
  const map = mapping(field, width, height);
  const world = scene.world?.valid ? scene.world : null;
  const own = world?.robots.find((robot) => isRobot(field, robot, chosen)) ?? null;
  const seen = scene.view && own ? seenBand(field, scene.view, own, THINNEST_BAND_PX / map.scale) : null;
  if (seen && own) drawSeenArea(pen, map, seen, own);
  drawPaint(pen, map, field);
  if (scene.layers.coverage) drawCoverage(pen, map, field);
  drawSegments(pen, map, field);
  if (seen) drawSeenEdges(pen, map, field, seen);
  if (!world) return;
  if (scene.layers.trails) scene.trails.draw(pen, map);
  for (const obstacle of world.obstacles) drawObstacle(pen, map, obstacle);
  for (const robot of world.robots) {
    drawRobot(pen, map, field, robot, robot === own);
    if (scene.layers.uncertainty) drawEllipse(pen, map, robot);
    if (isRobot(field, robot, scene.identified)) drawPulse(pen, map, field, robot, scene.now_s);
  }
  if (world.ball) drawBall(pen, map, field, world.ball);
}

function isRobot(field: Field, robot: WorldRobot, wanted: Robot | null): boolean {
  return wanted !== null && robot.team === wanted.team && numberOf(field, robot.team, robot.id) === wanted.number;
}

function drawPaint(pen: CanvasRenderingContext2D, map: FieldMap, field: Field): void {
  pen.strokeStyle = color("carpet-line");
  pen.lineWidth = Math.max(field.line_width_m * map.scale, 1);
  pen.beginPath();
  for (const [x1, y1, x2, y2] of field.lines as [number, number, number, number][]) {
    pen.moveTo(...map.at(x1, y1));
    pen.lineTo(...map.at(x2, y2));
  }
  for (const arc of field.arcs) {
    const [x, y] = map.at(arc.x_m, arc.y_m);
    const radius = arc.radius_m * map.scale;
    pen.moveTo(x + radius * Math.cos(arc.start_rad), y - radius * Math.sin(arc.start_rad));
    pen.arc(x, y, radius, -arc.start_rad, -arc.end_rad, true);
  }
  pen.stroke();
}

/** The border of what the camera sees of the floor. */
function drawCoverage(pen: CanvasRenderingContext2D, map: FieldMap, field: Field): void {
  if (field.coverage_m.length < 3) return;
  pen.beginPath();
  for (const [x, y] of field.coverage_m as [number, number][]) pen.lineTo(...map.at(x, y));
  pen.closePath();
  pen.strokeStyle = "#ffb04a";
  pen.lineWidth = 1.5;
  pen.setLineDash([2, 4]);
  pen.stroke();
  pen.setLineDash([]);
}

function drawSegments(pen: CanvasRenderingContext2D, map: FieldMap, field: Field): void {
  for (const segment of field.segments) {
    const isWall = segment.kind === field.edge_types.wall?.code;
    pen.strokeStyle = isWall ? "#11181499" : edgeLook(field, segment.kind).color;
    pen.lineWidth = segment.solid ? 4 : 1.5;
    pen.setLineDash(segment.solid ? [] : [6, 5]);
    pen.beginPath();
    pen.moveTo(...map.at(segment.x1_m, segment.y1_m));
    pen.lineTo(...map.at(segment.x2_m, segment.y2_m));
    pen.stroke();
  }
  pen.setLineDash([]);
}

function drawRobot(pen: CanvasRenderingContext2D, map: FieldMap, field: Field, robot: WorldRobot, isChosen: boolean): void {
  const [x, y] = map.at(robot.x_m, robot.y_m);
  const body = field.robots[robot.team];
  const radius = Math.max((body?.radius_m ?? 0.09) * map.scale, MIN_BODY_PX);
  const front = -robot.heading_rad;
  const headed = robot.heading_sd_rad <= HEADING_KNOWN_RAD;
  const square = headed && body?.outline === "square";
  const blue = robot.team === "blue";
  const predicted = robot.age_s > 0;
  const on = (ahead: number, aside: number): [number, number] => [
    x + radius * (ahead * Math.cos(front) - aside * Math.sin(front)),
    y + radius * (ahead * Math.sin(front) + aside * Math.cos(front)),
  ];
  pen.beginPath();
  if (square) for (const [ahead, aside] of [[1, 1], [-1, 1], [-1, -1], [1, -1]] as const) pen.lineTo(...on(ahead, aside));
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
  const ink = blue ? "#ffffff" : "#2a2000";
  if (square) {
    pen.beginPath();
    pen.moveTo(...on(BAR.ahead, -BAR.half));
    pen.lineTo(...on(BAR.ahead, BAR.half));
    pen.lineWidth = BAR.wide * radius;
    pen.strokeStyle = ink;
    pen.stroke();
  }
  const back = square ? BAR.wide * radius : 1.5;
  const label = robot.id === null ? "?" : robotLabel(field, robot.team, robot.id);
  const pale = blue ? "#a8c8ff" : "#ffe58a";
  writeLabel(pen, label, x, y, radius, { ink, pale, shift: [-back * Math.cos(front), -back * Math.sin(front)] });
}

interface LabelLook {
  ink: string;
  pale: string;
  shift: [number, number];
}

/** A label inside a body, or above one that is too small. */
function writeLabel(pen: CanvasRenderingContext2D, label: string, x: number, y: number, radius: number, look: LabelLook): void {
  pen.textAlign = "center";
  if (radius < MIN_LABELLED_PX) {
    pen.font = "600 10px system-ui, sans-serif";
    outlinedText(pen, label, x, y - radius - 4, look.pale);
    return;
  }
  pen.font = "700 11px system-ui, sans-serif";
  pen.fillStyle = look.ink;
  pen.textBaseline = "middle";
  pen.fillText(label, x + look.shift[0], y + look.shift[1] + 0.5);
  pen.textBaseline = "alphabetic";
}

/** The ellipse of SIGMAS standard deviations of a position. */
function drawEllipse(pen: CanvasRenderingContext2D, map: FieldMap, robot: WorldRobot): void {
  const [xx, xy, yy] = robot.covariance;
  const middle = (xx + yy) / 2;
  const spread = Math.hypot((xx - yy) / 2, xy);
  const [long, short] = [middle + spread, Math.max(middle - spread, 0)].map((v) => SIGMAS * Math.sqrt(v) * map.scale) as [number, number];
  const [x, y] = map.at(robot.x_m, robot.y_m);
  pen.beginPath();
  pen.ellipse(x, y, Math.max(long, MIN_ELLIPSE_PX), Math.max(short, MIN_ELLIPSE_PX), -Math.atan2(2 * xy, xx - yy) / 2, 0, 2 * Math.PI);
  pen.lineWidth = 1.5;
  pen.strokeStyle = "#ffffff";
  pen.stroke();
}

function drawPulse(pen: CanvasRenderingContext2D, map: FieldMap, field: Field, robot: WorldRobot, now_s: number): void {
  const [x, y] = map.at(robot.x_m, robot.y_m);
  const share = (now_s % PULSE_S) / PULSE_S;
  const radius = (field.robots[robot.team]?.radius_m ?? 0.09) * map.scale;
  pen.beginPath();
  pen.arc(x, y, radius * (1.2 + 1.5 * share), 0, 2 * Math.PI);
  pen.lineWidth = 5;
  pen.globalAlpha = 1 - share;
  pen.strokeStyle = "#ffffff";
  pen.stroke();
  pen.globalAlpha = 1;
}

function drawObstacle(pen: CanvasRenderingContext2D, map: FieldMap, obstacle: WorldObstacle): void {
  const [x, y] = map.at(obstacle.x_m, obstacle.y_m);
  const radius = Math.max(obstacle.radius_m * map.scale, MIN_BODY_PX);
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = color("unknown-body");
  pen.fill();
  pen.lineWidth = 1.2;
  pen.strokeStyle = "#ffffff";
  pen.stroke();
  writeLabel(pen, "?", x, y, radius, { ink: "#ffffff", pale: "#ffffff", shift: [0, 0] });
}

function drawBall(pen: CanvasRenderingContext2D, map: FieldMap, field: Field, ball: WorldBall): void {
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
