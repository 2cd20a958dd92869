// Shared by everything that shows something: sharp canvases, the colors of the theme, names of robots.

const style = getComputedStyle(document.documentElement);
const colors = new Map();
const darkTheme = matchMedia("(prefers-color-scheme: dark)");
const UNDEFINED_COLOR = "#ff00ff"; // of a code that the server's table lacks: loud, so that it is noticed
darkTheme.addEventListener("change", () => colors.clear());

/** A color of the style sheet by name. */
export function color(name) {
  if (!colors.has(name)) colors.set(name, style.getPropertyValue(`--${name}`).trim());
  return colors.get(name);
}

/** An empty canvas in units of CSS pixels, sharp on every screen. */
export function cleared(canvas) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const ratio = window.devicePixelRatio || 1;
  const pixels = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== pixels[0] || canvas.height !== pixels[1]) [canvas.width, canvas.height] = pixels;
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}

/** Text with an edge round it, readable on anything. */
export function outlinedText(pen, text, x, y, fill, edge = "#000000b0") {
  pen.lineJoin = "round";
  pen.lineWidth = 3;
  pen.strokeStyle = edge;
  pen.strokeText(text, x, y);
  pen.fillStyle = fill;
  pen.fillText(text, x, y);
}

/** The first of some boxes [x, y, width, height] that covers none that is taken; it is taken then. */
export function freeBox(taken, boxes) {
  const covers = ([x, y, w, h], [a, b, c, d]) => x < a + c && a < x + w && y < b + d && b < y + h;
  const free = boxes.find((box) => !taken.some((other) => covers(box, other)));
  if (free) taken.push(free);
  return free;
}

/** B3 for a robot that wears the marker of blue 3; B#7 for a marker of no number, B? for none. */
export function robotLabel(field, team, id) {
  const letter = team === "blue" ? "B" : "Y";
  if (id === null) return `${letter}?`;
  const number = field.marker_ids[team].indexOf(id) + 1;
  return number ? `${letter}${number}` : `${letter}#${id}`;
}

/** How an edge's code is drawn, by the server's table of edge types: color, a label to write beside it, thickness. */
export function edgeLook(field, code) {
  const type = Object.values(field.edge_types).find((one) => code >= one.code && code <= one.code + one.numbers);
  if (!type) return { color: UNDEFINED_COLOR, label: `code ${code}`, width: 3.5 };
  const number = type.numbers ? code - type.code || "?" : "";
  const { matches } = darkTheme;
  return { color: matches ? type.on_dark : type.on_light, label: `${type.label}${number}`, width: type.label ? 3.5 : 1.6 };
}

/** Fill the legend of the views: one entry per word of the server's table, then the ball. */
export function fillLegend(list, field) {
  const words = new Map();
  for (const type of Object.values(field.edge_types)) if (type.legend) words.set(type.legend, [...(words.get(type.legend) ?? []), type]);
  const entries = [...words].map(([word, types]) => {
    const entry = document.createElement("li");
    const [{ label, numbers, on_light, on_dark }] = types;
    entry.textContent = `${label}${numbers ? 1 : ""} ${word}`.trim();
    entry.title = types.map(({ meaning }) => meaning).join("; ");
    entry.className = types.length > 1 ? "shared" : label ? "labeled" : "";
    entry.style.setProperty("--on-light", on_light);
    entry.style.setProperty("--on-dark", on_dark);
    return entry;
  });
  const ball = document.createElement("li");
  ball.className = "ball";
  ball.textContent = "ball";
  list.replaceChildren(...entries, ball);
}

/** 1 robot, 2 robots. */
export function counted(number, thing) {
  return `${number} ${thing}${number === 1 ? "" : "s"}`;
}

/** Text that is set only when it differs, so that nothing flickers and selections stay. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** The bytes of a base64 string. */
export function bytesFrom(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

/** Runs of equal edge codes round the circle: [{code, start, length}], directions in degrees. */
export function runsOf(codes) {
  const count = codes.length;
  let first = 0;
  while (first < count && codes[first] === codes[(first + count - 1) % count]) first += 1;
  if (first === count) return [{ code: codes[0], start: 0, length: count }];
  const runs = [];
  for (let step = 0; step < count; step += 1) {
    const code = codes[(first + step) % count];
    const last = runs.at(-1);
    if (last && last.code === code) last.length += 1;
    else runs.push({ code, start: (first + step) % count, length: 1 });
  }
  return runs;
}
