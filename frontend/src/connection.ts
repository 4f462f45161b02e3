// The websocket, opened again whenever it is lost.

import { now, type FromPage, type FromServer } from "./messages";

/** Seconds between attempts to connect; the last one over and over. */
const WAITS = [0.3, 0.6, 1.2, 2.4, 4];

/** A question goes to the server so often, in seconds, and without an answer the line is dead. */
const PING_EVERY = 4;
const PATIENCE = 10;

export interface Listener {
  message(message: FromServer): void;
  /** The connection is gone; `tries` attempts to get it back have failed so far. */
  lost(tries: number): void;
}

export class Connection {
  readonly #url: string;
  readonly #listener: Listener;
  #socket: WebSocket | null = null;
  #tries = 0;
  #closed = false;
  #retry: number | undefined;
  #asked: number | null = null;
  /** Round trips, in seconds. */
  readonly trips: number[] = [];

  constructor(path: string, listener: Listener) {
    const url = new URL(path, location.href);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    this.#url = url.href;
    this.#listener = listener;
    window.setInterval(() => this.#ask(), 1000 * PING_EVERY);
    window.addEventListener("online", () => this.#open());
    window.addEventListener("offline", () => this.#drop());
    this.#open();
  }

  /** Say `message`; false where there is no connection. */
  send(message: FromPage): boolean {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  ping(): boolean {
    this.#asked = now();
    return this.send({ type: "ping", page_time: this.#asked });
  }

  /** No more is to come. */
  close(): void {
    this.#closed = true;
    window.clearTimeout(this.#retry);
    this.#socket?.close();
  }

  #open(): void {
    if (this.#closed || this.#socket) return;
    window.clearTimeout(this.#retry);
    const socket = new WebSocket(this.#url);
    this.#socket = socket;
    socket.onmessage = (event: MessageEvent<string>) => {
      const message = JSON.parse(event.data) as FromServer;
      this.#tries = 0;
      if (message.type === "pong") {
        this.#asked = null;
        this.trips.push(now() - message.page_time);
      }
      this.#listener.message(message);
    };
    socket.onopen = () => this.ping();
    socket.onclose = () => {
      if (this.#socket === socket) this.#gone();
    };
  }

  #gone(): void {
    [this.#socket, this.#asked] = [null, null];
    if (this.#closed) return;
    const wait = WAITS[Math.min(this.#tries, WAITS.length - 1)] ?? 1;
    this.#listener.lost(this.#tries);
    this.#tries += 1;
    // Pages that lost the same server do not come back all at once.
    this.#retry = window.setTimeout(() => this.#open(), 1000 * wait * (0.75 + Math.random() / 2));
  }

  /** Give up a line that is dead, without waiting for it to say so. */
  #drop(): void {
    const socket = this.#socket;
    if (!socket || this.#closed) return;
    this.#gone();
    socket.close();
  }

  #ask(): void {
    if (this.#asked !== null && now() - this.#asked > PATIENCE) this.#drop();
    else if (this.#asked === null) this.ping();
  }
}
