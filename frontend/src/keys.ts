// The keyboard: arrow keys or WASD give directions, digits the inputs that have none.

import { named, nearest, type Vector } from "./directions";

const WAYS: Readonly<Record<string, Vector>> = {
  ArrowLeft: [-1, 0],
  KeyA: [-1, 0],
  ArrowRight: [1, 0],
  KeyD: [1, 0],
  ArrowUp: [0, 1],
  KeyW: [0, 1],
  ArrowDown: [0, -1],
  KeyS: [0, -1],
};

const DIGIT = /^(?:Digit|Numpad)([1-9])$/;

/** How much the key pressed last turns the direction: of two opposite ones it wins. */
const LATEST = 0.1;

/** The keys that are held, by the place on the keyboard (`KeyboardEvent.code`), the latest last. */
export class Keys {
  readonly #directions: readonly Vector[];
  readonly #named: readonly number[];
  readonly #held: string[] = [];

  constructor(directions: readonly Vector[]) {
    this.#directions = directions;
    this.#named = named(directions);
  }

  /** Whether `code` steers at all. */
  steers(code: string): boolean {
    return code in WAYS || this.#digit(code) !== null;
  }

  press(code: string): void {
    if (this.steers(code) && !this.#held.includes(code)) this.#held.push(code);
  }

  release(code: string): void {
    const i = this.#held.indexOf(code);
    if (i >= 0) this.#held.splice(i, 1);
  }

  clear(): void {
    this.#held.length = 0;
  }

  /** The input that the held keys give. */
  get input(): number | null {
    const last = this.#held.at(-1);
    if (last === undefined) return null;
    const digit = this.#digit(last);
    if (digit !== null) return digit;
    let [right, ahead] = [0, 0];
    for (const code of this.#held) {
      const way = WAYS[code];
      const weight = code === last ? 1 + LATEST : 1;
      if (way) [right, ahead] = [right + weight * way[0], ahead + weight * way[1]];
    }
    return nearest(this.#directions, [right, ahead]) ?? this.#alone(last);
  }

  /** What the key pressed last gives by itself: with two opposite ones, or ones for nothing. */
  #alone(code: string): number | null {
    return nearest(this.#directions, WAYS[code] ?? [0, 0]);
  }

  #digit(code: string): number | null {
    const found = DIGIT.exec(code);
    return found ? (this.#named[Number(found[1]) - 1] ?? null) : null;
  }
}
