// The tables of clients and processes, and the strip on top. Text is touched only where it changed.

import { counted, setText } from "./drawing.js";

const $ = (id) => document.getElementById(id);
const GOOD_STATES = new Set(["running", "done"]);
const BAD_STATES = new Set(["disabled", "restarting"]);

/** Show a status (as of /api/v1/status); isSeen(client) tells whether a client's robot is. */
export function showStatus(status, pages, isSeen) {
  const camera = status.cameras[0];
  setText($("source"), status.source ? `${status.source.repeats ? "↻ repeats: " : ""}${shortName(status.source.uri)}` : "none");
  $("source").title = status.source ? `${status.source.uri}\n${status.source.description}` : "";
  setText($("camera-rate"), camera.measured_rate_hz === null ? "–" : `${camera.measured_rate_hz.toFixed(1)} Hz`);
  setText($("lag"), status.lag ? `${status.lag.median_ms.toFixed(1)}, ${status.lag.max_ms.toFixed(1)} ms` : "–");
  setText($("robot-count"), `${camera.robots}${camera.balls ? " + ball" : ""}`);
  $("robot-count").parentElement.title = `In the newest image: ${counted(camera.robots, "robot")}, ${counted(camera.balls, "ball")}, ${counted(camera.obstacles, "obstacle")}`;
  setText($("client-count"), String(status.clients.length));
  setText($("service"), `version ${status.version}, up ${duration(status.uptime_s)}, ${counted(pages, "page")} open`);
  showReasons(camera.reasons);
  setText($("refused"), status.refused.length ? `refused: ${status.refused.at(-1)}` : "");
  $("refused").title = status.refused.join("\n");
  showClients(status, isSeen);
  showProcesses(status.processes);
}

/** Why nothing, or too little, is detected: one line each. */
function showReasons(reasons) {
  const list = $("detection");
  while (list.children.length > reasons.length) list.lastElementChild.remove();
  reasons.forEach((reason, index) => setText(list.children[index] ?? list.appendChild(document.createElement("li")), reason));
  list.hidden = reasons.length === 0;
}

/** Show the verdict: kind is ready, not-ready or waiting. */
export function showVerdict(kind, text, reasons) {
  $("verdict").className = `pill ${kind}`;
  setText($("verdict"), text);
  setText($("reasons"), reasons.join("; "));
}

/** An age in words: 12 ms, 3.4 s. */
export function age(seconds) {
  return seconds < 1 ? `${Math.max(0, Math.round(seconds * 1000))} ms` : `${seconds.toFixed(1)} s`;
}

function duration(seconds) {
  const minutes = Math.floor(seconds / 60);
  if (minutes < 1) return `${Math.floor(seconds)} s`;
  return minutes < 60 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** Of a file or folder its own name only. */
function shortName(uri) {
  return uri.startsWith("file:") ? uri.replace(/\/+$/, "").split(/[:/]/).at(-1) : uri;
}

function showClients(status, isSeen) {
  $("no-clients").hidden = status.clients.length > 0;
  setText($("udp"), status.udp);
  const port = /:(\d+)(?:,|$)/.exec(status.udp)?.[1];
  setText($("try-it"), `python -m vision_core.client --host ${location.hostname} --port ${port} --team blue --number 1`);
  const rows = status.clients.map((client) => [
    [`${client.team} ${client.number}`, client.team],
    [`${client.address}:${client.port}`, "address"],
    isSeen(client) ? [client.rate_hz.toFixed(1), "number"] : ["⚠ not seen", "number wait"],
    [String(client.sent), "number"],
    [String(client.dropped), client.dropped ? "number bad" : "number"],
    [client.sent ? client.mean_rank.toFixed(2) : "–", "number"],
  ]);
  fill($("clients"), rows);
}

function showProcesses(processes) {
  const rows = [];
  for (const process of processes) {
    const look = GOOD_STATES.has(process.state) ? "good" : BAD_STATES.has(process.state) ? "bad" : "wait";
    rows.push([
      [process.name, ""],
      [process.state, look],
      [fixed(process.rate_hz), "number"],
      [fixed(process.response_median_ms), "number"],
      [fixed(process.response_max_ms), "number"],
      [String(process.restarts), process.restarts ? "number bad" : "number"],
      [process.pid === null ? "–" : String(process.pid), "number"],
    ]);
    const detail = [process.state === "done" ? "" : process.detail, process.note].filter(Boolean).join("; ");
    if (detail) rows.push([[detail, "detail"]]);
  }
  fill($("processes"), rows);
}

function fixed(value) {
  return value === null ? "–" : value.toFixed(1);
}

/** Make a table's body show rows of [text, class]; a row of one cell spans the table. */
function fill(body, rows) {
  while (body.rows.length > rows.length) body.deleteRow(-1);
  rows.forEach((cells, index) => {
    const row = body.rows[index] ?? body.insertRow();
    while (row.cells.length > cells.length) row.deleteCell(-1);
    cells.forEach(([text, look], column) => {
      const cell = row.cells[column] ?? row.insertCell();
      cell.colSpan = cells.length === 1 ? 7 : 1;
      if (cell.className !== look) cell.className = look;
      setText(cell, text);
    });
  });
}
