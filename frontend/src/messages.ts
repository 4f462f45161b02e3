// What page and server say to each other; the server's side is coadapt/study/server/messages.py.

export type Device = "keyboard" | "gamepad" | "touch" | "switch";

export interface Goal {
  name: string;
  states: number[];
}

export interface Steering {
  name: string;
  direction: [number, number];
}

export interface Scene {
  type: "scene";
  kind: "practice" | "trial";
  number: number;
  of: number;
  positions: [number, number][];
  free: [number, number][];
  goals: Goal[];
  inputs: Steering[];
  turns: "fixed" | "wait";
  step: number;
}

export interface Step {
  step: number;
  state: number;
  reached: number;
  input: number | null;
}

export type FromServer =
  | Scene
  | { type: "begun"; attempt: number; state: number }
  | { type: "stored"; sequence: number }
  | (Step & { type: "step" })
  | { type: "over"; goal: number | null }
  | { type: "pong"; page_time: number }
  | { type: "refused"; reason: string };

export type FromPage =
  | { type: "ready" }
  | {
      type: "input";
      input: number | null;
      device: Device;
      sequence: number;
      page_time: number;
      device_time: number | null;
    }
  | { type: "note"; what: string; value: number | null; text: string }
  | { type: "ping"; page_time: number };

/** Seconds of the page's clock. */
export function now(): number {
  return performance.now() / 1000;
}
