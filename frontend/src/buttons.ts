// The inputs as buttons on the page: for touch and mouse, and to show what is held.

import { length } from "./directions";
import type { Steering } from "./messages";
import { element, shape } from "./shapes";

export class Buttons {
  readonly element: HTMLElement;
  readonly #buttons: HTMLButtonElement[];

  /**
   * `pressed` is told which input a finger or the mouse holds from now on, or null; `keyed` the same
   * of a button that is held by the keyboard.
   */
  constructor(
    inputs: readonly Steering[],
    pressed: (input: number | null) => void,
    keyed: (input: number | null) => void,
  ) {
    this.#buttons = inputs.map((input, i) => button(input, i, pressed, keyed));
    const pad = element("div", { class: "pad" });
    const rest = element("div", { class: "pad named" });
    const way = (value: number) => (value < -0.3 ? 0 : value > 0.3 ? 2 : 1);
    const highest = inputs.some(({ direction }) => direction[1] > 0.3) ? 0 : 1;
    for (const [i, { direction }] of inputs.entries()) {
      const made = this.#buttons[i];
      if (!made) continue;
      const size = length(direction);
      if (size === 0) {
        rest.append(made);
        continue;
      }
      made.style.gridColumn = String(1 + way(direction[0] / size));
      made.style.gridRow = String(1 + 2 - way(direction[1] / size) - highest);
      pad.append(made);
    }
    this.element = element("div", { role: "group", "aria-label": "Directions" });
    this.element.append(...[pad, rest].filter((part) => part.childElementCount > 0));
  }

  /** Show which input is held. */
  hold(input: number | null): void {
    this.#mark("held", input);
  }

  /** Show which input the scan is at. */
  scan(input: number | null): void {
    this.#mark("scanned", input);
  }

  /** Show that `input` has been tried. */
  tried(input: number): void {
    this.#buttons[input]?.classList.add("tried");
  }

  untry(): void {
    for (const made of this.#buttons) made.classList.remove("tried");
  }

  /** Whether Tab stops at each button. */
  set tabbed(tabbed: boolean) {
    for (const made of this.#buttons) made.tabIndex = tabbed ? 0 : -1;
  }

  /** Whether the buttons are only there to be looked at: a click on one is one beside it. */
  set inert(inert: boolean) {
    this.element.inert = inert;
  }

  #mark(name: string, input: number | null): void {
    for (const [i, made] of this.#buttons.entries()) made.classList.toggle(name, i === input);
  }
}

function button(
  input: Steering,
  index: number,
  pressed: (input: number | null) => void,
  keyed: (input: number | null) => void,
): HTMLButtonElement {
  const made = element("button", { type: "button", "aria-label": input.name });
  made.append(length(input.direction) > 0 ? picture(input.direction) : input.name);
  made.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.preventDefault();
    // Released anywhere, by whatever happens, it is released.
    made.setPointerCapture(event.pointerId);
    pressed(index);
  });
  made.addEventListener("lostpointercapture", () => pressed(null));
  made.addEventListener("contextmenu", (event) => event.preventDefault());
  made.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    if (!event.repeat) keyed(index);
  });
  made.addEventListener("keyup", (event) => {
    if (event.key === "Enter" || event.key === " ") keyed(null);
  });
  made.addEventListener("blur", () => keyed(null));
  return made;
}

function picture([right, ahead]: readonly [number, number]): SVGElement {
  const turn = (Math.atan2(-ahead, right) * 180) / Math.PI;
  const drawn = shape("path", {
    d: "M-10 -3H1V-10L12 0L1 10V3H-10Z",
    fill: "currentColor",
    transform: `rotate(${turn.toFixed(1)})`,
  });
  return shape("svg", { viewBox: "-14 -14 28 28", "aria-hidden": "true" }, drawn);
}
