// A robot's client in TypeScript for Node, without packages; it speaks version 2 of docs/protocol.md, or version 1.
//
// node pslv_client.ts [--raw] [TEAM [NUMBER [HOST [PORT [VIEWS [OPTIONS [VX VY OMEGA]]]]]]]   OPTIONS: "(types team)"
// The team's key, if it has one, is read from the variable PSLV_KEY: other users can read the words of a command.
//
// Node 22.18 or newer runs it as it is. Copy the file and replace main: connect, then next in your loop, then close.

import { createSocket } from "node:dgram";
import type { RemoteInfo, Socket } from "node:dgram";
import { lookup } from "node:dns/promises";

const RETRY_S = 0.5; // between two inits until one is answered
const PATIENCE_S = 1; // after an error that passes; and silence, until the session's port is asked
const RESTART_S = 3; // silence, until the main port is asked: the server may have been restarted
const LEASE_S = 15; // assumed where the server does not tell it
const NOTHING_PX = 255;

const NUMBER = String.raw`(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)`;
const EDGES = String.raw`\(\(edge\) ((?:[!-'*-~][0-9a-f]{2})*)\)`;
const BALL = String.raw`\(\(ball\) (-?\d{1,3}) (-?\d{1,3}) (-?\d{1,3})\)`;
const SEE = new RegExp(String.raw`^\(see (\d{1,10}(?:\.\d+)?) ${EDGES} ${BALL}(.*)\)$`, "s");

const MEANINGS: Record<string, string> = {
  already_connected: "another program has this robot, and it still runs",
  not_admitted: "the server does not serve this computer (its key admission.subnets)",
  replaced: "a newer program has this robot",
  unknown_command: "the server does not tell its mirror",
  wrong_key: "this is not the team's key",
};

export interface Edge {
  /** Type of the nearest edge. */
  letter: string;
  /** Its distance in the mirror's image, -1: nothing within range. */
  px: number;
  /** Its distance on the floor, Infinity: nothing. */
  mm: number;
  /** From straight ahead. */
  directionDeg: number;
}

export interface View {
  /** When the image was grabbed, since the server's start. */
  timeS: number;
  edges: Edge[];
  /** px is -1 and mm Infinity when the ball is hidden. */
  ball: { px: number; directionDeg: number; sizeDeg: number; mm: number };
  /** The camera does not see this robot now. */
  unseen: boolean;
}

export class PslvClient {
  /** Init was answered, and the mirror is known. */
  open = false;
  /** An error that passes, as not_ready; empty: none. */
  waiting = "";
  /** A, B, C. */
  mirror: number[] = [];
  /** Width and center of the field of view [deg]. */
  fov = [360, 180];
  /** Degrees between two directions. */
  resolution = 1;

  private version = 0; // that the server speaks; 0: not known yet
  private leaseS = LEASE_S;
  private cookie = "";
  private boot = "";
  private timeS = -1;
  private heardS = 0;
  private askedS = 0;
  private ended = "";
  private newest: View | null = null;
  private wake: () => void = () => {};
  private server: number; // the port that views come from
  private readonly timer: NodeJS.Timeout;
  private readonly socket: Socket;
  private readonly host: string;
  private readonly port: number;
  private readonly robot: string;
  private readonly wishes: string;

  /** Ask for a robot's views. options: as "(types team) (rate 10)"; key: the team's. next shows if it is answered. */
  static async connect(host: string, port: number, team: string, number: number, options = "", key = "") {
    const { address } = await lookup(host, 4);
    return new PslvClient(address, port, `${team} ${number}`, `(version 2) ${options}${key && ` (key ${key})`}`);
  }

  private constructor(address: string, port: number, robot: string, wishes: string) {
    this.host = address;
    this.port = this.server = port;
    this.robot = robot;
    this.wishes = wishes;
    this.socket = createSocket("udp4", (datagram, from) => this.receive(datagram, from));
    this.socket.on("error", () => {}); // the network is down: the server's silence shows it
    this.timer = setInterval(() => this.askIfDue(), 100);
    this.ask(this.port);
  }

  /** The newest view that was not taken yet; null if none comes in time. Throws when the server ends the session. */
  async next(timeoutS: number): Promise<View | null> {
    if (!this.newest && !this.ended) {
      let timer: NodeJS.Timeout | undefined;
      await new Promise<void>((resolve) => {
        this.wake = resolve;
        timer = setTimeout(resolve, 1e3 * timeoutS);
      });
      clearTimeout(timer);
    }
    if (this.ended) throw new Error(this.ended);
    const view = this.newest;
    this.newest = null;
    return view;
  }

  /** Drive a simulated robot: forward, left [m/s], anticlockwise [rad/s]; kick: speed [m/s]. Taken: no answer. */
  drive(vx: number, vy: number, omega: number, kick = 0, dribble = false): void {
    const numbers = [vx, vy, omega].map((speed) => speed.toFixed(4)).join(" ");
    this.send(`(drive ${numbers} (kick ${kick.toFixed(4)})${dribble ? " (dribble)" : ""})`, this.server);
  }

  /** End the session. */
  close(): void {
    clearInterval(this.timer);
    const done = () => this.socket.close();
    if (this.version && !this.ended) this.socket.send("(bye)", this.server, this.host, done);
    else done();
  }

  private send(text: string, port: number): void {
    this.socket.send(text, port, this.host, () => {});
  }

  /** Send init. Only version 1 has to be asked for the mirror. */
  private ask(port: number): void {
    const cookie = this.cookie && ` (cookie ${this.cookie})`;
    this.send(`(init ${this.robot} ${this.wishes}${cookie})${this.version === 1 ? "(mirror)" : ""}`, port);
    this.askedS = nowS();
  }

  /** Repeat init until it is answered; then to keep the session, and to learn what a lost message would have told. */
  private askIfDue(): void {
    const silentS = nowS() - this.heardS;
    if (silentS >= RESTART_S) [this.open, this.version] = [false, 0];
    const waitS = !this.open ? RETRY_S : silentS >= PATIENCE_S ? PATIENCE_S : Math.max(this.leaseS / 3, RETRY_S);
    if (!this.ended && nowS() - this.askedS >= waitS) this.ask(this.open ? this.server : this.port);
  }

  private receive(datagram: Buffer, from: RemoteInfo): void {
    if (from.address !== this.host || this.ended) return;
    const text = datagram.toString("latin1").replace(/[\0\s]+$/, "");
    const [, name = "", word = ""] = /^\((\w+) ?([^ ()]*)/.exec(text) ?? [];
    if (name === "error" && word) {
      this.takeError(word);
      return;
    }
    if (!name) return;
    [this.heardS, this.waiting] = [nowS(), ""];
    if (name === "see") this.takeSee(text, from.port);
    if (name === "init" && word) this.takeInit(text, from.port);
    if (name === "mirror" && this.takeMirror(text, "\\(mirror ") && this.version === 1) this.open = true;
    if (name === "hear") this.takeMirror(text, " mirror ");
    if (name === "ping") this.send(text, from.port);
    if (name === "challenge" && word) {
      this.cookie = word;
      this.ask(from.port);
    }
    // a match has begun: its mirror and field of view are in the answer to init
    if (text === "(warning fixed_by_match)" && this.open && nowS() - this.askedS >= PATIENCE_S) this.ask(from.port);
  }

  /** An error that passes: ask again a second later. Any other ends the session. */
  private takeError(error: string): void {
    if (["not_ready", "rate_limited", "not_connected"].includes(error)) {
      [this.waiting, this.open] = [error, false];
      this.askedS = nowS() + PATIENCE_S - RETRY_S;
    } else {
      this.ended = `error ${error}: ${MEANINGS[error] ?? "see docs/protocol.md"}`;
      this.wake();
    }
  }

  /** The answer to init: facts in version 2, none in version 1, where the mirror has to be asked for. */
  private takeInit(text: string, port: number): void {
    const boot = /\(boot ([^()]*)\)/.exec(text)?.[1] ?? "";
    if (!boot || boot !== this.boot) this.timeS = -1; // Time has begun anew
    [this.boot, this.server] = [boot, port];
    const [leaseS] = numbersAfter(text, "\\(lease ", 1);
    this.version = leaseS && this.takeMirror(text, "\\(mirror ") ? 2 : 1;
    this.leaseS = leaseS ?? LEASE_S;
    const [fov, [resolution]] = [numbersAfter(text, "\\(fov ", 2), numbersAfter(text, "\\(resolution ", 1)];
    if (fov.length) this.fov = fov;
    this.resolution = resolution ?? this.resolution;
    if (this.version === 2) this.open = true;
    else if (!this.open) this.send("(mirror)", port);
  }

  private takeMirror(text: string, mark: string): boolean {
    const found = numbersAfter(text, mark, 3);
    const [a, b, c] = found;
    const valid = c > 0 && b >= 0 && a > b * Math.sqrt(c);
    if (valid) this.mirror = found;
    return valid;
  }

  private takeSee(text: string, port: number): void {
    const found = SEE.exec(text);
    if (!found || !this.open || Number(found[1]) <= this.timeS) return;
    const [, time, edges, px, direction, size, rest] = found;
    const first = this.fov[1] - this.fov[0] / 2 + 720;
    this.server = port;
    this.timeS = Number(time);
    this.newest = {
      timeS: this.timeS,
      edges: (edges.match(/.../gs) ?? []).map((edge, i) => {
        const value = parseInt(edge.slice(1), 16);
        const px = value === NOTHING_PX ? -1 : value;
        return { letter: edge[0], px, mm: this.mmFromPx(px), directionDeg: (first + i * this.resolution) % 360 };
      }),
      ball: { px: Number(px), directionDeg: Number(direction), sizeDeg: Number(size), mm: this.mmFromPx(Number(px)) },
      unseen: rest.includes("nopose"),
    };
    this.wake();
  }

  /** Distance on the floor; the server rounds pixels down, so their middle is half a pixel more. */
  private mmFromPx(px: number): number {
    const [a, b, c] = this.mirror;
    const r = px + 0.5;
    const slope = a - b * Math.sqrt(c + r * r);
    return px >= 0 && slope > 0 ? r / slope : Infinity;
  }
}

function nowS(): number {
  return performance.now() / 1e3;
}

/** The numbers that follow a mark, anywhere in a message; empty when they do not. */
function numbersAfter(text: string, mark: string, count: number): number[] {
  const found = new RegExp(mark + Array(count).fill(NUMBER).join(" ")).exec(text);
  return found ? found.slice(1).map(Number) : [];
}

/** Time, edges as the server sent them, the ball's pixels, direction and size, millimetres ahead and to the ball. */
function rawLine({ timeS, edges, ball }: View): string {
  const sent = edges.map(({ letter, px }) => letter + (px & NOTHING_PX).toString(16).padStart(2, "0")).join("");
  const [ahead, toBall] = [edges[0]?.mm ?? Infinity, ball.mm].map((mm) => (mm === Infinity ? "-" : mm.toFixed(1)));
  return `${timeS.toFixed(3)} ${sent} ${ball.px} ${ball.directionDeg} ${ball.sizeDeg} ${ahead} ${toBall}`;
}

function line({ timeS, edges, ball, unseen }: View): string {
  if (unseen) return `${timeS.toFixed(3)} s: the camera does not see the robot`;
  const ahead = edges[0] && edges[0].px >= 0 ? `${edges[0].letter} at ${edges[0].px} px` : "nothing";
  const where = ball.px >= 0 ? `${ball.px} px at ${ball.directionDeg} deg` : "hidden";
  return `${timeS.toFixed(3)} s: ahead ${ahead}, ball ${where}`;
}

async function main(words: string[]): Promise<void> {
  const raw = words[0] === "--raw";
  const given = words.slice(raw ? 1 : 0);
  const defaults = ["blue", "3", "127.0.0.1", "6000", "100", "", "", "0", "0"].slice(given.length);
  const [team, number, host, port, views, options, ...speeds] = [...given, ...defaults];
  const [vx, vy, omega] = speeds.map(Number);
  const robot = await PslvClient.connect(host, Number(port), team, Number(number), options, process.env.PSLV_KEY);
  let [seen, stopped] = [0, false];
  process.once("SIGINT", () => (stopped = true)); // the robot is given back with bye
  try {
    while (!stopped && seen < Number(views)) {
      const view = await robot.next(5);
      if (view) {
        seen++;
        console.log(raw ? rawLine(view) : line(view));
        if (speeds[0]) robot.drive(vx, vy, omega);
        continue;
      }
      const why = robot.open ? "the camera does not see the robot" : "nothing answers at that address";
      console.error(`no view for 5 s: ${robot.waiting || why}`);
      if (!seen && !robot.waiting) {
        process.exitCode = 1;
        break;
      }
    }
  } finally {
    robot.close();
  }
}

main(process.argv.slice(2)).catch((error: Error) => {
  console.error(error.message);
  process.exitCode = 1;
});
