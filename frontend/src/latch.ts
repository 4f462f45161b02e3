// A short tap between two decisions of the robot must not be lost.

/** An input, and when the page saw it. */
export interface Change {
  input: number | null;
}

/**
 * Holds back the message that an input was let go of until the robot has decided with that input
 * once. Under a fixed clock the server takes the input that is held when the clock strikes, and a
 * tap that is shorter than a step would never be. The message keeps its own time: the log says when
 * the input was let go of.
 */
export class Latch<Some extends Change> {
  readonly #send: (change: Some) => void;
  #held: number | null = null;
  #waiting: Some | null = null;

  constructor(send: (change: Some) => void) {
    this.#send = send;
  }

  change(change: Some): void {
    if (change.input === null && this.#held !== null) {
      this.#waiting = change;
      return;
    }
    this.#release();
    this.#held = change.input;
    this.#send(change);
  }

  /** The robot has decided with `input`. */
  decided(input: number | null): void {
    if (input === null || input !== this.#held) return;
    this.#held = null;
    this.#release();
  }

  /** A new attempt: what was under way is void. */
  reset(): void {
    [this.#held, this.#waiting] = [null, null];
  }

  #release(): void {
    if (this.#waiting) this.#send(this.#waiting);
    this.#waiting = null;
  }
}
