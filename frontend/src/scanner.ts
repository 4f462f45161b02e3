// One switch: the inputs light up one after the other, and a press takes the one that is lit.

export type ScanMode = "hold" | "click";

export class Scanner {
  readonly #count: number;
  #seconds: number;
  #mode: ScanMode;
  #since: number | null = null;
  #lit = 0;
  #held: number | null = null;

  /**
   * `seconds`: for which each input is lit. `mode`: "hold" gives the input while the switch is held,
   * "click" from one press to the next.
   */
  constructor(count: number, seconds: number, mode: ScanMode) {
    this.#count = count;
    this.#seconds = seconds;
    this.#mode = mode;
  }

  /** The input that is lit. */
  get lit(): number {
    return this.#lit;
  }

  /** The input that is given, or null. */
  get held(): number | null {
    return this.#held;
  }

  adjust(seconds: number, mode: ScanMode): void {
    [this.#seconds, this.#mode] = [seconds, mode];
  }

  /** Go on scanning; `time` in seconds. */
  tick(time: number): void {
    this.#since ??= time;
    if (this.#held !== null || this.#count === 0) return;
    const passed = Math.floor((time - this.#since) / this.#seconds);
    if (passed > 0) {
      this.#lit = (this.#lit + passed) % this.#count;
      this.#since += passed * this.#seconds;
    }
  }

  press(time: number): void {
    this.tick(time);
    if (this.#held === null) this.#held = this.#count > 0 ? this.#lit : null;
    else if (this.#mode === "click") this.clear(time);
  }

  release(time: number): void {
    if (this.#mode === "hold" && this.#held !== null) this.clear(time);
  }

  /** Give nothing; the scan goes on from where it is. */
  clear(time: number): void {
    [this.#held, this.#since] = [null, time];
  }
}
