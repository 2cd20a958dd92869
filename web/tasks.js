// The table of tasks: what starts each of them, its granted priority, its response times.

import { cleared, color, counted, setText } from "./drawing.js";

const FIRST_DECADE = -2; // of milliseconds: 0.01 ms at the left of a histogram
const DECADES = 5;
const BAD_STATES = new Set(["disabled", "restarting"]);
const COLUMNS = ["name", "trigger", "priority", "rate", "median", "p99", "max", "histogram", "jitter", "missed", "overruns", "restarts"];
const WORDS = new Set(["name", "trigger", "priority", "histogram"]);

const body = document.getElementById("tasks");
const rows = new Map(); // by name of the task
let drawn = null; // times that the histograms show

/** Show times (of the topic timing) beside the processes of a status. */
export function showTasks(times, processes) {
  if (times.tasks.map(({ name }) => name).join() !== [...rows.keys()].join()) makeRows(times.tasks);
  const states = new Map(processes.map((process) => [process.name, process]));
  const timings = new Map(times.timing.tasks.map((timing) => [timing.name, timing]));
  const explained = new Set(); // processes whose state is shown already
  for (const task of times.tasks) {
    const row = rows.get(task.name);
    const process = states.get(task.process);
    showTask(row, task, process, timings.get(task.name));
    showDetail(row, task, explained.has(task.process) ? null : process);
    explained.add(task.process);
    if (times !== drawn) drawHistogram(row.canvas, timings.get(task.name)?.response, task);
  }
  drawn = times;
  const others = processes.filter(({ name }) => !explained.has(name));
  setText(document.getElementById("other-processes"), others.map(({ name, state, detail }) => `${name} ${state}${state === "done" || !detail ? "" : `: ${detail}`}`).join(", "));
}

function makeRows(tasks) {
  rows.clear();
  body.replaceChildren();
  for (const { name } of tasks) {
    const line = body.insertRow();
    const cells = {};
    for (const column of COLUMNS) {
      cells[column] = line.insertCell();
      if (!WORDS.has(column)) cells[column].className = "number";
    }
    const canvas = cells.histogram.appendChild(document.createElement("canvas"));
    canvas.setAttribute("role", "img");
    const below = body.insertRow();
    const detail = below.insertCell();
    detail.colSpan = COLUMNS.length;
    detail.className = "detail";
    rows.set(name, { line, cells, canvas, below, detail });
  }
}

function showTask({ line, cells }, task, process, timing) {
  const lost = process && BAD_STATES.has(process.state);
  line.className = task.enabled ? "" : "off";
  setLook(cells.name, lost ? "bad" : process?.state === "running" ? "" : "wait", `${task.name}${task.proposed ? " ✎" : ""}`);
  cells.name.title = [`process ${task.process}${process ? `: ${process.state}, id ${process.pid ?? "none"}` : ""}`, override(task.proposed)].filter(Boolean).join("\n");
  setText(cells.trigger, released(task));
  cells.trigger.title = `trigger ${task.trigger ?? "not reported yet"}, period ${task.period_ms} ms, offset ${task.offset_ms} ms, budget ${task.budget_ms} ms`;
  setLook(cells.priority, task.refused ? "wait" : "", `${task.refused ? "⚠ " : ""}${task.policy ?? "–"}`);
  cells.priority.title = task.refused || "";
  setLook(cells.rate, task.enabled ? "number" : "number wait", task.enabled ? fixed(task.valid ? task.rate_hz : null, 1) : "off");
  const { p50 = null, p99 = null, max = null } = timing?.response ?? {};
  setText(cells.median, short(p50));
  setText(cells.p99, short(p99));
  setText(cells.max, short(max));
  setText(cells.jitter, short(task.runs ? task.interval_sd_ms : null));
  count(cells.missed, task.missed);
  count(cells.overruns, task.overruns);
  count(cells.restarts, process?.restarts ?? null);
}

/** Below a task: why its process does not run, and its note. The page shows the note of its own process elsewhere. */
function showDetail({ below, detail }, task, process) {
  const state = process && process.state !== "running" ? [`process ${process.name} is ${process.state}${process.detail ? `: ${process.detail}` : ""}`] : [];
  const words = [...state, task.trigger === "none" ? "" : task.note].filter(Boolean).join("; ");
  setText(detail, words);
  below.hidden = !words;
}

/** What starts a task, in a word or two. */
function released({ trigger, period_ms }) {
  if (period_ms) return period_ms < 1000 ? `every ${period_ms} ms` : `every ${period_ms / 1000} s`;
  if (trigger === null) return "–";
  return trigger === "none" ? "own loop" : trigger.split("/")[0];
}

function override(proposed) {
  if (!proposed) return "";
  const values = Object.entries(proposed).filter(([, value]) => value !== null);
  return `changed while it runs: ${values.map(([key, value]) => `${key} ${value}`).join(", ")}`;
}

function setLook(cell, look, text) {
  if (cell.className !== look) cell.className = look;
  setText(cell, text);
}

function count(cell, value) {
  setLook(cell, value ? "number some" : "number", value === null ? "–" : String(value));
}

const fixed = (value, digits) => (value === null ? "–" : value.toFixed(digits));

/** Milliseconds with about two significant digits. */
function short(value_ms) {
  return fixed(value_ms, value_ms < 0.995 ? 2 : value_ms < 9.95 ? 1 : 0);
}

/** Bars over the logarithm of the response, as high as the logarithm of how often it came; a line at the budget. */
function drawHistogram(canvas, response, task) {
  const { pen, width, height } = cleared(canvas);
  const at = (value_ms) => Math.min(Math.max((Math.log10(value_ms) - FIRST_DECADE) / DECADES, 0), 1) * width;
  pen.fillStyle = color("line");
  for (let decade = 0; decade <= DECADES; decade += 1) pen.fillRect(Math.min(Math.round((decade / DECADES) * width), width - 1), 0, 1, height);
  if (task.budget_ms) {
    pen.fillStyle = color("wait");
    pen.fillRect(Math.round(at(task.budget_ms)), 0, 1, height);
  }
  const bars = new Float64Array(Math.ceil(width / 2) + 1);
  for (const [upper_ms, number] of response?.bins ?? []) bars[Math.floor(at(upper_ms) / 2)] += number;
  const highest = Math.log1p(Math.max(...bars));
  pen.fillStyle = color("focus");
  bars.forEach((number, index) => {
    const tall = number ? Math.max(1, Math.round((Math.log1p(number) / highest) * height)) : 0;
    pen.fillRect(2 * index, height - tall, 2, tall);
  });
  const words = response?.count ? `${counted(response.count, "run")}: half within ${short(response.p50)} ms, 99 % within ${short(response.p99)} ms, all within ${short(response.max)} ms` : "no run yet";
  canvas.setAttribute("aria-label", words);
  canvas.title = words;
}
