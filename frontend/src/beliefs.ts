// What the robot believes, as bars: for researchers. No page of a participant has this program.

import { element, set, shape } from "./shapes";

const [WIDE, HIGH, GAP] = [150, 22, 6];

/** Bars for the probabilities of some values. */
class Bars {
  readonly element: HTMLElement;
  readonly #bars: SVGRectElement[];
  readonly #numbers: SVGTextElement[];

  constructor(title: string, names: readonly string[]) {
    this.#bars = names.map((_, i) =>
      shape("rect", { x: 90, y: i * (HIGH + GAP), width: 0, height: HIGH, fill: "#0b5a66" }),
    );
    this.#numbers = names.map((_, i) =>
      shape("text", { x: 96 + WIDE, y: i * (HIGH + GAP) + 16, "font-size": 14 }),
    );
    const labels = names.map((name, i) =>
      shape("text", { x: 84, y: i * (HIGH + GAP) + 16, "font-size": 14, "text-anchor": "end" }, name),
    );
    const tracks = names.map((_, i) =>
      shape("rect", { x: 90, y: i * (HIGH + GAP), width: WIDE, height: HIGH, fill: "#dde3e7" }),
    );
    const height = names.length * (HIGH + GAP);
    const box = { viewBox: `0 0 ${WIDE + 150} ${height}`, width: "100%" };
    const drawn = shape("svg", box, ...tracks, ...this.#bars, ...labels, ...this.#numbers);
    this.element = element("figure", {}, element("figcaption", {}, title));
    this.element.append(drawn);
  }

  show(values: readonly number[]): void {
    for (const [i, value] of values.entries()) {
      const [bar, number] = [this.#bars[i], this.#numbers[i]];
      if (bar) set(bar, { width: WIDE * value });
      if (number) number.textContent = value.toFixed(3);
    }
  }
}

export class Beliefs {
  readonly #adaptability: Bars;
  readonly #modes: Bars;

  /** Draws into `parent`. */
  constructor(parent: Element, adaptability: readonly number[], modes: readonly string[]) {
    this.#adaptability = new Bars(
      "Belief over adaptability",
      adaptability.map((value) => `α = ${Number(value.toFixed(3))}`),
    );
    this.#modes = new Bars("Belief over the mode", modes);
    parent.append(this.#adaptability.element, this.#modes.element);
  }

  /** `belief`: `[A][M]`. */
  show(belief: readonly (readonly number[])[]): void {
    const sum = (values: readonly number[]) => values.reduce((total, value) => total + value, 0);
    this.#adaptability.show(belief.map(sum));
    this.#modes.show((belief[0] ?? []).map((_, m) => sum(belief.map((row) => row[m] ?? 0))));
  }
}
