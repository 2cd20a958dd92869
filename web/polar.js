// One tile per robot: its view as its client gets it, heading up, anticlockwise to the left.
// The radius is in pixels of the mirror (equation 1), so near things take more room than far ones.

import { bytesFrom, cleared, color, edgeLook, freeBox, runsOf, setText } from "./drawing.js";

const RINGS_M = [0.25, 0.5, 1, 2, 4, 8];
const MIN_RING_GAP_PX = 7;
const MIN_LABELLED_DEG = 4;
const LABEL_INSET_PX = 9;
const LABEL_PX = [13, 10]; // width and height
const ARROW_PX = 20;
const BALL_PX = 9;
const FLAGS = { partial: "The ball is partly hidden", overlap: "Another robot's outline holds this one's center" };
const NO_EDGE = 255;
const DEG = Math.PI / 180;

/** Make the tiles of both teams, blue left and yellow right; onChoose({team, number}) when one is pressed. */
export function makeTiles(parent, field, onChoose) {
  parent.replaceChildren();
  const tiles = [];
  for (let number = 1; number <= field.numbers; number += 1) {
    for (const team of ["blue", "yellow"]) {
      const tile = document.createElement("button");
      tile.type = "button";
      tile.className = `tile ${team}`;
      tile.setAttribute("aria-pressed", "false");
      tile.innerHTML =
        '<canvas role="img"></canvas><span class="who"></span><span class="client"></span>' +
        '<span class="ball"></span><span class="flags"></span><span class="unseen-robot">not seen</span>';
      const part = (name) => tile.querySelector(`.${name}`);
      part("who").textContent = `${team === "blue" ? "B" : "Y"}${number}`;
      tile.addEventListener("click", () => onChoose({ team, number }));
      parent.append(tile);
      tiles.push({
        team, number, tile, canvas: tile.querySelector("canvas"),
        client: part("client"), ball: part("ball"), flags: part("flags"), empty: part("unseen-robot"),
      });
    }
  }
  return tiles;
}

/** Draw one tile; view and client are undefined when there is none. */
export function drawTile(entry, field, view, client, isChosen) {
  entry.tile.setAttribute("aria-pressed", String(isChosen));
  const rate = client && (client.rate_hz || view) ? `${client.rate_hz.toFixed(1)}/s` : "";
  setText(entry.client, client ? `${rate}${client.dropped ? ` −${client.dropped}` : ""}` : "no client");
  entry.client.classList.toggle("served", Boolean(client?.rate_hz));
  entry.client.title = client ? `${client.dropped} dropped` : "";
  entry.empty.hidden = Boolean(view);
  entry.empty.classList.toggle("missed", Boolean(client));
  setText(entry.ball, !view ? "" : view.ball_px < 0 ? "no ball" : `ball ${view.ball_px} px, ${view.ball_direction_deg}°`);
  const flags = view ? Object.keys(FLAGS).filter((flag) => view[flag]) : [];
  setText(entry.flags, flags.join(", "));
  entry.flags.title = flags.map((flag) => FLAGS[flag]).join("; ");
  const { pen, width, height } = cleared(entry.canvas);
  if (view) drawDial(pen, width, height, field, view);
}

/** What a tile says to somebody who cannot see it. */
export function describeTile(entry, view) {
  const who = `${entry.team} ${entry.number}`;
  const ball = view && view.ball_px >= 0 ? `ball at ${view.ball_direction_deg} degrees, ${view.ball_px} pixels` : "no ball";
  entry.canvas.setAttribute("aria-label", view ? `View of ${who}: ${ball}` : `${who} is not seen`);
}

function drawDial(pen, width, height, field, view) {
  const outer = Math.min(width, height) / 2 - 1;
  const { farthest, rings } = scaleOf(field);
  const scale = (outer - 2) / farthest;
  pen.translate(width / 2, height / 2);
  pen.beginPath();
  pen.arc(0, 0, outer, 0, 2 * Math.PI);
  pen.fillStyle = color("dial");
  pen.fill();
  const px = bytesFrom(view.px);
  const codes = bytesFrom(view.kinds);
  const place = (direction, radius) => [-radius * Math.sin(direction * DEG), -radius * Math.cos(direction * DEG)];
  const radius = (direction) => (px[direction] === NO_EDGE ? farthest : Math.min(px[direction], farthest)) * scale;
  pen.beginPath();
  for (let direction = 0; direction < px.length; direction += 1) pen.lineTo(...place(direction, radius(direction)));
  pen.closePath();
  pen.fillStyle = color("seen");
  pen.fill();
  drawRings(pen, rings, scale);
  const runs = runsOf(codes).filter(({ code }) => code !== field.edge_types.nothing.code);
  for (const run of runs) drawRun(pen, field, run, px.length, place, radius);
  const ball = view.ball_px < 0 ? null : place(view.ball_direction_deg, view.ball_px * scale);
  drawLabels(pen, field, runs, px.length, place, radius, ball);
  if (ball) drawBall(pen, view, scale, place);
  drawBody(pen, field, view.team, scale);
}

/** Pixels of the mirror up to the field's diagonal, and where the rings lie. */
function scaleOf(field) {
  const pxOf = (metres) => {
    const beyond = field.mirror_m.findIndex((value) => value === null || value > metres);
    return beyond < 0 ? field.mirror_m.length - 1 : beyond;
  };
  return { farthest: pxOf(Math.hypot(field.length_m, field.width_m)) + 2, rings: RINGS_M.map((m) => [m, pxOf(m)]) };
}

function drawRings(pen, rings, scale) {
  pen.strokeStyle = color("ring");
  pen.lineWidth = 0.8;
  let last = 0;
  for (const [, px] of rings) {
    if ((px - last) * scale < MIN_RING_GAP_PX) continue;
    last = px;
    pen.beginPath();
    pen.arc(0, 0, px * scale, 0, 2 * Math.PI);
    pen.stroke();
  }
}

function drawRun(pen, field, run, count, place, radius) {
  const look = edgeLook(field, run.code);
  pen.strokeStyle = look.color;
  pen.lineWidth = look.width;
  pen.lineJoin = "round";
  pen.beginPath();
  for (let step = 0; step < run.length; step += 1) {
    const direction = (run.start + step) % count;
    pen.lineTo(...place(direction - 0.5, radius(direction)));
    pen.lineTo(...place(direction + 0.5, radius(direction)));
  }
  pen.stroke();
}

/** Names beside the edges, the widest first; one that would cover another, the arrow or the ball is left out. */
function drawLabels(pen, field, runs, count, place, radius, ball) {
  const [wide, high] = LABEL_PX;
  const square = (x, y, size) => [x - size / 2, y - size / 2, size, size];
  const taken = [square(0, 0, ARROW_PX)];
  if (ball) taken.push(square(...ball, BALL_PX));
  pen.font = "700 9px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  for (const run of [...runs].sort((one, other) => other.length - one.length)) {
    const look = edgeLook(field, run.code);
    if (!look.label || run.length < MIN_LABELLED_DEG) continue;
    const middle = run.start + run.length / 2;
    const [x, y] = place(middle, radius(Math.floor(middle) % count) - LABEL_INSET_PX);
    if (!freeBox(taken, [[x - wide / 2, y - high / 2, wide, high]])) continue;
    pen.fillStyle = look.color;
    pen.fillText(look.label, x, y);
  }
}

function drawBall(pen, view, scale, place) {
  const radius = view.ball_px * scale;
  const half = view.ball_size_deg / 2;
  const [x, y] = place(view.ball_direction_deg, radius);
  pen.strokeStyle = color("ball");
  pen.lineWidth = 5;
  pen.beginPath();
  for (let offset = -half; offset <= half; offset += 1) pen.lineTo(...place(view.ball_direction_deg + offset, radius));
  pen.stroke();
  pen.beginPath();
  pen.arc(x, y, BALL_PX / 2, 0, 2 * Math.PI);
  pen.fillStyle = color("ball");
  pen.fill();
  pen.lineWidth = 1;
  pen.strokeStyle = color("ink");
  pen.stroke();
}

function drawBody(pen, field, team, scale) {
  const own = field.mirror_m.findIndex((metres) => metres === null || metres > field.robots[team].radius_m);
  const size = Math.min(Math.max(own * scale, 4), 9);
  pen.fillStyle = color("dim");
  pen.beginPath();
  pen.moveTo(0, -size);
  pen.lineTo(size * 0.7, size * 0.7);
  pen.lineTo(0, size * 0.35);
  pen.lineTo(-size * 0.7, size * 0.7);
  pen.fill();
}
