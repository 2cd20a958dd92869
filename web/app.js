// The page: one live connection, everything is drawn from its newest update.

import { counted, fillLegend, robotLabel, setText } from "./drawing.js";
import { drawField, obstacleAt, robotAt } from "./field.js";
import { connect } from "./live.js";
import { drawPicture } from "./picture.js";
import { describeTile, drawTile, makeTiles } from "./polar.js";
import { age, showStatus, showVerdict } from "./tables.js";
import { showTasks } from "./tasks.js";

const $ = (id) => document.getElementById(id);
const STALE_AFTER_S = 0.5;
const TABLES_EVERY_MS = 250;
const DESCRIBE_EVERY_MS = 2000;
const CLOCK_DRIFT = 1e-4;

let field = null; // of /api/v1/field
let tiles = [];
let state = null; // newest state
let picture = null;
let times = null; // of the tasks
let received = 0; // when the newest update came [s of this page's clock]
let ahead = -Infinity; // the service's clock minus this page's [s]; a late message can only make it too small
let linked = false;
let chosen = null; // {team, number}
let unnamed = ""; // words about an object that was clicked and cannot be chosen

connect(onUpdate, onLink);
setInterval(showAges, 100);
setInterval(showTables, TABLES_EVERY_MS);
setInterval(describe, DESCRIBE_EVERY_MS);
for (const id of ["show-robots", "show-ball", "show-obstacles", "show-lines"]) $(id).addEventListener("change", draw);
new ResizeObserver(draw).observe($("field"));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
$("field").addEventListener("click", ({ offsetX, offsetY }) => clickField(robotUnder(offsetX, offsetY), obstacleUnder(offsetX, offsetY)));
$("field").addEventListener("mousemove", ({ offsetX, offsetY }) => {
  const robot = robotUnder(offsetX, offsetY);
  const obstacle = obstacleUnder(offsetX, offsetY);
  $("field").style.cursor = robot ? "pointer" : obstacle ? "help" : "";
  $("field").title = robot ? robotLabel(field, robot.team, robot.id) : obstacle ? obstacleWords(obstacle) : "";
});
addEventListener("keydown", ({ key }) => {
  if (key === "Escape") choose(null);
});

const robotUnder = (x, y) => (field && state ? robotAt($("field"), field, state, x, y) : null);
const obstacleUnder = (x, y) => (field && state ? obstacleAt($("field"), field, state, x, y) : null);
const seconds = () => performance.now() / 1000;

function onUpdate(newState, newPicture, newTimes) {
  ahead = Math.max(newState.now_s - seconds(), ahead - CLOCK_DRIFT * (seconds() - received));
  received = seconds();
  if (newPicture && newPicture !== picture) {
    picture?.bitmap.close();
    picture = newPicture;
  }
  const first = state === null;
  state = newState;
  times = newTimes;
  draw();
  if (first) showTables();
}

async function onLink(open, reason) {
  linked = open;
  document.body.classList.toggle("lost", !open);
  if (open) {
    ahead = -Infinity;
    await loadField();
  } else {
    showVerdict("not-ready", "connection lost", [reason || "trying again"], []);
  }
  showAges();
}

/** The service may have been started anew with other settings. */
async function loadField() {
  try {
    const fresh = await (await fetch("/api/v1/field")).json();
    if (JSON.stringify(fresh) === JSON.stringify(field)) return;
    field = fresh;
    fillLegend($("legend"), field);
    tiles = makeTiles($("views"), field, toggle);
    draw();
  } catch {
    // the connection went again; the next one tries again
  }
}

function clickField(robot, obstacle) {
  if (!robot && !obstacle) return choose(null);
  if (robot?.number) return toggle(robot);
  unnamed = !robot ? obstacleWords(obstacle) : `${robotLabel(field, robot.team, robot.id)}: its number cannot be read, so no robot is sent its view`;
  caption();
}

function obstacleWords({ radius_m, x_m, y_m }) {
  return `?: no known robot and no ball, ${Math.round(200 * radius_m)} cm wide, at ${x_m.toFixed(2)} m, ${y_m.toFixed(2)} m`;
}

function toggle(robot) {
  choose(isChosen(robot) ? null : robot);
}

function choose(robot) {
  chosen = robot;
  unnamed = "";
  if (chosen) tiles.find(isChosen).tile.scrollIntoView({ block: "nearest" });
  draw();
}

/** What the field shows just now. */
function caption() {
  const name = chosen && `${chosen.team} ${chosen.number}`;
  const words = !chosen ? "Choose a robot to see what it sees."
    : viewOf(chosen) ? `What ${name} sees; far edges are as coarse as one pixel of its mirror` : `${name} is not seen`;
  setText($("selected"), unnamed || words);
  $("selected").classList.toggle("missed", !unnamed && chosen !== null && !viewOf(chosen));
}

function draw() {
  if (!field || !state) return;
  const camera = state.status.cameras[0];
  const show = Object.fromEntries(["robots", "ball", "obstacles", "lines"].map((part) => [part, $(`show-${part}`).checked]));
  if (picture) drawPicture($("picture"), picture.bitmap, field, camera, state, show, chosen);
  drawField($("field"), field, state, chosen);
  for (const entry of tiles) drawTile(entry, field, viewOf(entry), clientOf(entry), isChosen(entry));
  caption();
}

const viewOf = ({ team, number }) =>
  state.views?.valid ? state.views.value.views.find((view) => view.team === team && view.number === number) : undefined;
const clientOf = ({ team, number }) =>
  state.status.clients.find((client) => client.team === team && client.number === number);
const isChosen = ({ team, number }) => chosen !== null && chosen.team === team && chosen.number === number;

function showTables() {
  if (!state) return;
  showStatus(state.status, state.pages, (client) => viewOf(client) !== undefined);
  if (times) showTasks(times, state.status.processes);
  const { state: condition, reasons, alarms } = state.status;
  const words = condition.replace("_", " ");
  if (linked) showVerdict(words.replace(" ", "-"), words, reasons, alarms);
  setText($("picture-empty"), reasons[0] ?? "no image yet");
  $("picture-empty").hidden = picture !== null;
}

/** Ages run on while nothing comes. */
function showAges() {
  if (!state) return;
  const silent_s = seconds() - received;
  const picture_s = picture ? seconds() + ahead - picture.grabbed_s : null;
  setText($("picture-age"), picture_s === null ? "–" : age(picture_s));
  $("picture-age").classList.toggle("late", picture_s > STALE_AFTER_S);
  markStale("picture", picture_s, "picture");
  markStale("field", state.world ? state.world.age_s + silent_s : null, "positions");
}

function markStale(id, age_s, what) {
  const stale = age_s !== null && age_s > STALE_AFTER_S;
  $(`${id}-stale`).hidden = !stale;
  $(id).parentElement.classList.toggle("is-stale", stale);
  if (stale) setText($(`${id}-stale`), `${what} ${age(age_s)} old`);
}

/** Words for those who cannot see the canvases; not faster than they can be read. */
function describe() {
  if (!state || !field) return;
  const world = state.world?.valid ? state.world.value : null;
  const ball = world?.ball ? `, ball at ${world.ball.x_m.toFixed(2)} m, ${world.ball.y_m.toFixed(2)} m` : ", no ball";
  const things = world?.obstacles.length ? `, ${counted(world.obstacles.length, "obstacle")}` : "";
  $("field").setAttribute("aria-label", world ? `The field from above: ${counted(world.robots.length, "robot")}${ball}${things}` : "The field from above: nothing known");
  $("picture").setAttribute("aria-label", picture ? `The camera's picture ${picture.number}` : "No picture yet");
  for (const entry of tiles) describeTile(entry, viewOf(entry));
}
