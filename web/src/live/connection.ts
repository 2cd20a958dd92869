// The live connection: requests an update, takes it, requests the next one. Reconnects by itself.
// An update is the newest unseen message of each topic that somebody on the page needs, and ends with {"topic": "end"}.

import { decoded } from "./messages";

const RETRY_MS = [300, 500, 1000, 2000];
const SILENCE_MS = 3000; // the service sends a status at least four times a second

export interface Received {
  topic: string;
}
type Listener = (message: never) => void;

export class LiveConnection {
  private socket: WebSocket | null = null;
  private failures = 0;
  private watchdog = 0;
  private retry = 0;
  private readonly listeners = new Map<string, Set<Listener>>();
  private asked = "";
  private stopped = true;

  /** onLink(open, reason): the link has opened, or is lost. onEnd(now_s): an update is complete. */
  constructor(
    private readonly onLink: (open: boolean, reason: string) => void,
    private readonly onEnd: (now_s: number) => void,
  ) {
    document.addEventListener("visibilitychange", () => {
      if (this.stopped) return;
      if (document.hidden) this.drop();
      else if (!this.socket) this.open();
    });
  }

  start(): void {
    this.stopped = false;
    if (!this.socket) this.open();
  }

  /** End the connection and open it anew: somebody has logged in or out. */
  restart(): void {
    this.drop();
    this.failures = 0;
    this.start();
  }

  /** Take a topic's messages from now on; returns the function that ends it. */
  subscribe<T extends Received>(topic: string, listener: (message: T) => void): () => void {
    const own = listener as unknown as Listener;
    const others = this.listeners.get(topic) ?? new Set();
    this.listeners.set(topic, others.add(own));
    this.askForTopics();
    return () => {
      others.delete(own);
      if (!others.size) this.listeners.delete(topic);
      this.askForTopics();
    };
  }

  private topics(): string {
    return [...this.listeners.keys()].sort().join(",");
  }

  private askForTopics(): void {
    if (this.socket?.readyState !== WebSocket.OPEN || this.asked === this.topics()) return;
    this.asked = this.topics();
    this.socket.send(JSON.stringify({ topics: this.asked.split(",").filter(Boolean) }));
  }

  private open(): void {
    clearTimeout(this.retry);
    this.asked = this.topics();
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const mine = new WebSocket(`${scheme}://${location.host}/live?topics=${encodeURIComponent(this.asked)}`);
    let pending: Promise<unknown> = Promise.resolve();
    this.socket = mine;
    mine.binaryType = "arraybuffer";
    mine.onopen = () => {
      this.failures = 0;
      this.onLink(true, "");
      mine.send("next");
      this.askForTopics();
      this.guard(mine);
    };
    mine.onmessage = ({ data }) => {
      this.guard(mine);
      pending = pending.then(() => this.take(mine, data as ArrayBuffer | string));
    };
    mine.onclose = ({ reason }) => {
      if (mine === this.socket) this.lost(reason);
    };
  }

  private async take(mine: WebSocket, data: ArrayBuffer | string): Promise<void> {
    const message = typeof data === "string" ? (JSON.parse(data) as Received) : await decoded(data);
    if (mine !== this.socket || !message) return;
    if (message.topic === "end") {
      this.onEnd((message as unknown as { now_s: number }).now_s);
      if (mine.readyState === WebSocket.OPEN) mine.send("next");
      return;
    }
    for (const listener of this.listeners.get(message.topic) ?? []) (listener as (m: Received) => void)(message);
  }

  private lost(reason: string): void {
    clearTimeout(this.watchdog);
    clearTimeout(this.retry);
    this.socket = null;
    this.onLink(false, reason);
    if (document.hidden || this.stopped) return;
    this.retry = window.setTimeout(() => this.open(), RETRY_MS[Math.min(this.failures++, RETRY_MS.length - 1)]);
  }

  private guard(mine: WebSocket): void {
    clearTimeout(this.watchdog);
    this.watchdog = window.setTimeout(() => {
      if (mine === this.socket) this.drop();
    }, SILENCE_MS);
  }

  private drop(): void {
    const mine = this.socket;
    if (!mine) return;
    this.lost("");
    mine.close();
  }
}
