// Gamepads: what a push of a stick, a cross or a button is, for known pads and for calibrated ones.

import { length, named, nearest, type Vector } from "./directions";

export type Way = "left" | "right" | "forward" | "back";

export const WAYS: Readonly<Record<Way, Vector>> = {
  left: [-1, 0],
  right: [1, 0],
  forward: [0, 1],
  back: [0, -1],
};

/**
 * Something on a pad that gives a way: a button; an axis that goes from its value at rest towards
 * its value when pushed; or an axis that has just that value (a cross that is reported as one axis).
 */
export type Part =
  | { kind: "button"; button: number }
  | { kind: "axis"; axis: number; rest: number; full: number }
  | { kind: "value"; axis: number; full: number };

export type Layout = Readonly<Record<Way, readonly Part[]>>;

/** What is read of a pad; `Gamepad` has it. */
export interface Reading {
  axes: readonly number[];
  buttons: readonly { pressed: boolean; value: number }[];
}

/** How near an axis has to be to a value that it jumps to. */
const NEAR = 0.1;

/** The part of the dead zone in which a stick that was pushed still counts as pushed. */
const RELEASED = 0.8;

function axis(index: number, full: number): Part {
  return { kind: "axis", axis: index, rest: 0, full };
}

/** The layout that browsers call "standard": both sticks and the cross. */
export const STANDARD: Layout = {
  left: [axis(0, -1), axis(2, -1), { kind: "button", button: 14 }],
  right: [axis(0, 1), axis(2, 1), { kind: "button", button: 15 }],
  forward: [axis(1, -1), axis(3, -1), { kind: "button", button: 12 }],
  back: [axis(1, 1), axis(3, 1), { kind: "button", button: 13 }],
};

/** How far `part` is pushed, from 0 to 1. */
export function pushed(part: Part, reading: Reading): number {
  switch (part.kind) {
    case "button":
      return reading.buttons[part.button]?.pressed ? 1 : 0;
    case "axis": {
      const value = reading.axes[part.axis] ?? part.rest;
      return Math.min(1, Math.max(0, (value - part.rest) / (part.full - part.rest)));
    }
    case "value":
      return Math.abs((reading.axes[part.axis] ?? Number.NaN) - part.full) < NEAR ? 1 : 0;
  }
}

/** Where a pad is pushed to. */
export function push(layout: Layout, reading: Reading): Vector {
  const far = (way: Way) => Math.max(0, ...layout[way].map((part) => pushed(part, reading)));
  return [far("right") - far("left"), far("forward") - far("back")];
}

/** Turns readings of a pad into inputs: a dead zone, and what is held is kept a little longer. */
export class Pad {
  readonly #directions: readonly Vector[];
  readonly #named: readonly number[];
  #held: number | null = null;

  constructor(directions: readonly Vector[]) {
    this.#directions = directions;
    this.#named = named(directions);
  }

  /** The input of this reading; `deadZone` is the least push that counts, from 0 to 1. */
  read(layout: Layout, reading: Reading, deadZone: number): number | null {
    const vector = push(layout, reading);
    const least = this.#held === null ? deadZone : deadZone * RELEASED;
    this.#held =
      length(vector) >= least
        ? nearest(this.#directions, vector, this.#held)
        : this.#pressed(reading);
    return this.#held;
  }

  /** The first buttons of a pad stand for the inputs that have no direction. */
  #pressed(reading: Reading): number | null {
    return this.#named.find((_, k) => reading.buttons[k]?.pressed) ?? null;
  }
}
