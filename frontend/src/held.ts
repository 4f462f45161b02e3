// What is held on any of the devices: the latest press counts.

import type { Device } from "./messages";

export interface Holding {
  input: number | null;
  device: Device;
  deviceTime: number | null;
}

export class Held {
  readonly #on: (holding: Holding) => void;
  readonly #inputs = new Map<Device, number>();
  readonly #waiting = new Set<Device>();
  #current: Device | null = null;

  /** `on` is told of every change. */
  constructor(on: (holding: Holding) => void) {
    this.#on = on;
  }

  get input(): number | null {
    return this.#current === null ? null : (this.#inputs.get(this.#current) ?? null);
  }

  /** `device` gives `input` from now on, or null. `deviceTime`: its own time, in seconds. */
  set(device: Device, input: number | null, deviceTime: number | null = null): void {
    if (input === null) this.#waiting.delete(device);
    if (this.#waiting.has(device) || input === (this.#inputs.get(device) ?? null)) return;
    const before = this.input;
    if (input === null) {
      this.#inputs.delete(device);
      if (this.#current === device) this.#current = [...this.#inputs.keys()].at(-1) ?? null;
    } else {
      this.#inputs.delete(device);
      this.#inputs.set(device, input);
      this.#current = device;
    }
    if (this.input !== before) {
      this.#on({ input: this.input, device: this.#current ?? device, deviceTime });
    }
  }

  /** A new attempt: what is held now counts only once it has been let go of. */
  reset(): void {
    for (const device of this.#inputs.keys()) this.#waiting.add(device);
    this.#inputs.clear();
    this.#current = null;
  }
}
