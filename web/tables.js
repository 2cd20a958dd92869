// The table of clients, and the strip on top. Text is touched only where it changed.

import { counted, setText } from "./drawing.js";

const $ = (id) => document.getElementById(id);

/** Show a status (as of /api/v1/status); isSeen(client) tells whether a client's robot is. */
export function showStatus(status, pages, isSeen) {
  const camera = status.cameras[0];
  setText($("source"), status.source ? `${status.source.repeats ? "↻ repeats: " : ""}${shortName(status.source.uri)}` : "none");
  $("source").title = status.source ? `${status.source.uri}\n${status.source.description}` : "";
  setText($("camera-rate"), camera.measured_rate_hz === null ? "–" : `${camera.measured_rate_hz.toFixed(1)} Hz`);
  showLags(status.lags);
  setText($("robot-count"), `${camera.robots}${camera.balls ? " + ball" : ""}`);
  $("robot-count").parentElement.title = `In the newest image: ${counted(camera.robots, "robot")}, ${counted(camera.balls, "ball")}, ${counted(camera.obstacles, "obstacle")}`;
  setText($("client-count"), String(status.clients.length));
  setText($("service"), `version ${status.version}, up ${duration(status.uptime_s)}, ${counted(pages, "page")} open`);
  showReasons(camera.reasons);
  const refused = status.refused.map(({ address, port, error }) => `${address} port ${port}: ${error}`);
  setText($("refused"), refused.length ? `refused: ${refused.at(-1)}` : "");
  $("refused").title = refused.join("\n");
  showClients(status, isSeen);
}

/** The parts of the lag: what is the server's, and what clients report of the rest. */
function showLags({ server, network, client, shutter_delay_ms: shutter }) {
  const parts = [["server (lag A)", server], ["network (lag B)", network], ["robot's program (lag C)", client]];
  setText($("lag"), parts.map(([, part]) => (part ? part.median_ms.toFixed(1) : "–")).join(" · "));
  const words = parts.map(([name, part]) => `${name}: ${part ? `${part.median_ms.toFixed(2)} ms median, ${part.max_ms.toFixed(2)} ms max` : "not reported"}`);
  $("lag").parentElement.title = ["From the grab of an image until a robot's program has used its view: server, network, program", ...words, `before that, the shutter's delay: ${shutter} ms`].join("\n");
}

/** Why nothing, or too little, is detected: one line each. */
function showReasons(reasons) {
  list($("detection"), reasons);
}

/**
 * Show the state of the service: kind is ready, degraded, not-ready or waiting; reasons say why no robot is served,
 * alarms {text, detail} what is worse than it should be. People who run a match read the texts, technicians the details.
 */
export function showVerdict(kind, text, reasons, alarms) {
  $("verdict").className = `pill ${kind}`;
  setText($("verdict"), text);
  setText($("reasons"), reasons.join("; "));
  $("reasons").hidden = reasons.length === 0;
  list($("degraded"), [...new Set(alarms.map((alarm) => alarm.text))]);
  list($("alarm-details"), alarms.filter(({ detail }) => detail).map((alarm) => `${alarm.text}: ${alarm.detail}`));
}

/** Sentences as a list, which is there while it holds any. */
function list(element, sentences) {
  while (element.children.length > sentences.length) element.lastElementChild.remove();
  sentences.forEach((sentence, index) => setText(element.children[index] ?? element.appendChild(document.createElement("li")), sentence));
  element.hidden = sentences.length === 0;
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
    [`${client.team} ${client.number}`, client.team, `${client.address}:${client.port}`],
    [`${client.address}:${client.port}`, "address"],
    isSeen(client) ? [client.rate_hz.toFixed(1), "number"] : ["⚠ not seen", "number wait"],
    [lag(client.network_ms), "number"],
    [lag(client.client_ms), "number"],
    [String(client.dropped), client.dropped ? "number bad" : "number"],
    [String(client.sent), "number minor"],
  ]);
  fill($("clients"), rows);
}

function lag(value_ms) {
  return value_ms === null ? "–" : value_ms.toFixed(1);
}

/** Make a table's body show rows of [text, class, title]. */
function fill(body, rows) {
  while (body.rows.length > rows.length) body.deleteRow(-1);
  rows.forEach((cells, index) => {
    const row = body.rows[index] ?? body.insertRow();
    cells.forEach(([text, look, title = ""], column) => {
      const cell = row.cells[column] ?? row.insertCell();
      if (cell.className !== look) cell.className = look;
      if (cell.title !== title) cell.title = title;
      setText(cell, text);
    });
  });
}
