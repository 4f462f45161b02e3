// Learning the layout of a pad that the browser does not know: the person pushes each way once.

import type { Layout, Part, Reading, Way } from "./gamepads";

/** A change of an axis by less than this is no push. */
const CLEAR = 0.5;

/** A stick at rest stays within this of where it was. */
const STILL = 0.2;

/** Readings in a row that a push and a rest must last, so that no half-way value is taken. */
const LASTING = 6;

/** What an axis says at rest lies in here, unless it is a cross reported as an axis. */
const LARGEST_REST = 1.01;

function snapshot(reading: Reading): Reading {
  const buttons = reading.buttons.map(({ pressed, value }) => ({ pressed, value }));
  return { axes: [...reading.axes], buttons };
}

export class Calibration {
  readonly #ways: readonly Way[];
  readonly #parts = new Map<Way, Part>();
  #rest: Reading | null = null;
  #candidate: Part | null = null;
  #lasted = 0;
  #released = true;

  constructor(ways: readonly Way[]) {
    this.#ways = ways;
  }

  /** The way to push next; null when all are known. */
  get asked(): Way | null {
    return this.#ways.find((way) => !this.#parts.has(way)) ?? null;
  }

  /** Whether all ways are known and the pad is at rest again. */
  get done(): boolean {
    return this.asked === null && this.#released;
  }

  /** Whether the pad has to be let go of now. */
  get letGo(): boolean {
    return !this.#released;
  }

  /** The layout learnt so far. */
  get layout(): Layout {
    const of = (way: Way): Part[] => {
      const part = this.#parts.get(way);
      return part ? [this.#refined(part)] : [];
    };
    return { left: of("left"), right: of("right"), forward: of("forward"), back: of("back") };
  }

  /** Take in a reading; call it at every look at the pad. */
  read(reading: Reading): void {
    this.#rest ??= snapshot(reading);
    const found = this.#found(reading, this.#rest);
    if (!this.#released) {
      this.#lasted = found === null ? this.#lasted + 1 : 0;
      if (this.#lasted >= LASTING) [this.#released, this.#lasted] = [true, 0];
      return;
    }
    const way = this.asked;
    if (found === null || way === null) {
      [this.#candidate, this.#lasted] = [null, 0];
      return;
    }
    this.#lasted = this.#candidate && same(this.#candidate, found) ? this.#lasted + 1 : 1;
    this.#candidate = found;
    if (this.#lasted >= LASTING && ![...this.#parts.values()].some((part) => same(part, found))) {
      this.#parts.set(way, found);
      [this.#candidate, this.#lasted, this.#released] = [null, 0, false];
    }
  }

  /** The part that is pushed now: a button, or the axis that moved most. */
  #found(reading: Reading, rest: Reading): Part | null {
    const button = reading.buttons.findIndex((b, i) => b.pressed && !rest.buttons[i]?.pressed);
    if (button >= 0) return { kind: "button", button };
    let best: Part | null = null;
    let most = this.#released ? CLEAR : STILL;
    for (const [i, value] of reading.axes.entries()) {
      const start = rest.axes[i] ?? 0;
      if (Math.abs(value - start) > most) {
        most = Math.abs(value - start);
        best = { kind: "axis", axis: i, rest: start, full: value };
      }
    }
    return best;
  }

  /** An axis that gives more than two ways, or rests outside its range, is a cross. */
  #refined(part: Part): Part {
    if (part.kind !== "axis") return part;
    const alike = [...this.#parts.values()].filter((p) => p.kind === "axis" && p.axis === part.axis);
    const cross = alike.length > 2 || Math.abs(part.rest) > LARGEST_REST;
    return cross ? { kind: "value", axis: part.axis, full: part.full } : part;
  }
}

function same(a: Part, b: Part): boolean {
  if (a.kind === "button" || b.kind === "button") {
    return a.kind === "button" && b.kind === "button" && a.button === b.button;
  }
  return a.axis === b.axis && Math.abs(a.full - b.full) < STILL;
}
