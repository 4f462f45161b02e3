// The drawing of a task: table, goals, robot. It shows what happened and decides nothing.

import { arm, arrow, bottle, gripper, table, type Arm, type Bottle } from "./figures";
import type { Scene } from "./messages";
import { shape, set } from "./shapes";
import { CELL, raised, View, type Place } from "./view";

/** Seconds in which the hand grasps and lifts. */
const GRASP = 0.5;

/** Drawing units of the goals' names, at least and at most. */
const [LABEL, LARGEST_LABEL] = [0.36 * CELL, 1.2 * CELL];

/** Cells that a grasped bottle is lifted. */
const LIFT = 0.7;

interface Glide {
  from: Place;
  to: Place;
  begun: number;
  seconds: number;
}

export class Arena {
  readonly #scene: Scene;
  readonly #view: View;
  readonly #svg: SVGSVGElement;
  readonly #arm: Arm;
  readonly #hand: SVGGElement;
  readonly #bottles: Bottle[];
  readonly #arrow: SVGGElement;
  readonly #still: MediaQueryList;
  #place: Place = [0, 0, 0];
  #glide: Glide | null = null;
  #frame = 0;

  /** Draws into `element`, which belongs to the arena from now on. */
  constructor(element: Element, scene: Scene) {
    this.#scene = scene;
    this.#view = new View(scene);
    this.#still = window.matchMedia("(prefers-reduced-motion: reduce)");
    const view = this.#view;
    this.#svg = shape("svg", {
      viewBox: `0 0 ${view.width.toFixed(0)} ${view.height.toFixed(0)}`,
      role: "img",
    });
    this.#arm = arm();
    this.#hand = gripper();
    this.#arrow = shape("g", { visibility: "hidden" });
    this.#bottles = scene.goals.map((goal) => bottle(view, goal));
    this.#svg.append(
      table(view, scene),
      this.#arrow,
      this.#arm.shadow,
      ...this.#bottles.map(({ whole }) => whole),
      this.#arm.links,
      this.#hand,
    );
    element.replaceChildren(this.#svg);
    this.#label();
    new ResizeObserver(() => this.#label()).observe(this.#svg);
    this.show(0);
  }

  /** Write the names at least as large as the text of the page, on phones too. */
  #label(): void {
    const { width, height } = this.#svg.getBoundingClientRect();
    const scale = Math.min(width / this.#view.width, height / this.#view.height);
    const text = Number.parseFloat(getComputedStyle(document.documentElement).fontSize);
    const size = Math.max(LABEL, Math.min(scale > 0 ? text / scale : 0, LARGEST_LABEL));
    for (const drawn of this.#bottles) drawn.label(size);
  }

  /** Put the hand over `state`, at once, with everything as at the beginning. */
  show(state: number): void {
    this.#stop();
    for (const { body } of this.#bottles) body.removeAttribute("transform");
    this.#hand.classList.remove("closed");
    this.#say(state);
    this.#draw(this.#at(state));
  }

  /** Move the hand to `step.reached` within `seconds`, from wherever it is drawn now. */
  step(step: { state: number; reached: number }, seconds: number): void {
    const to = this.#at(step.reached);
    this.#stop();
    this.#say(step.reached);
    if (this.#still.matches || seconds <= 0) {
      this.#draw(to);
      return;
    }
    this.#glide = { from: this.#place, to, begun: performance.now(), seconds };
    this.#frame = requestAnimationFrame((time) => this.#move(time));
  }

  /** Show the input that is held, or none. */
  input(index: number | null): void {
    const steering = index === null ? undefined : this.#scene.inputs[index];
    set(this.#arrow, { visibility: steering ? "visible" : "hidden" });
    if (steering) this.#arrow.replaceChildren(...arrow(this.#view, steering));
  }

  /** The attempt is over: grasp what stands at `goal`, once the hand is there. */
  finish(goal: number | null): Promise<void> {
    this.input(null);
    const drawn = goal === null ? undefined : this.#bottles[goal];
    return new Promise((done) => {
      const arrive = () => {
        if (this.#glide) {
          requestAnimationFrame(arrive);
          return;
        }
        if (drawn) this.#lift(drawn.body, performance.now(), done);
        else done();
      };
      // Frames stop in a tab that is not seen; the end must not wait for them.
      window.setTimeout(done, 1000 * (GRASP + this.#scene.step + 1));
      arrive();
    });
  }

  #lift(drawn: SVGGElement, begun: number, done: () => void): void {
    this.#hand.classList.add("closed");
    const move = (time: number) => {
      const part = this.#still.matches ? 1 : Math.min(1, (time - begun) / 1000 / GRASP);
      const up = LIFT * Math.max(0, 2 * part - 1);
      const [, low] = this.#view.at([0, 0, 0]);
      const [, high] = this.#view.at([0, 0, up]);
      set(drawn, { transform: `translate(0 ${(high - low).toFixed(2)})` });
      this.#draw(this.#place, up);
      if (part < 1) requestAnimationFrame(move);
      else done();
    };
    requestAnimationFrame(move);
  }

  #move(time: number): void {
    const glide = this.#glide;
    if (!glide) return;
    const part = Math.min(1, Math.max(0, (time - glide.begun) / 1000 / glide.seconds));
    const between = (i: 0 | 1 | 2) => glide.from[i] + part * (glide.to[i] - glide.from[i]);
    this.#draw([between(0), between(1), between(2)]);
    if (part < 1) this.#frame = requestAnimationFrame((next) => this.#move(next));
    else this.#glide = null;
  }

  #stop(): void {
    cancelAnimationFrame(this.#frame);
    this.#glide = null;
  }

  #at(state: number): Place {
    return this.#view.places[state] ?? [0, 0, 0];
  }

  #draw(place: Place, up = 0): void {
    this.#place = place;
    const view = this.#view;
    const hand = raised(place);
    const lifted: Place = [hand[0], hand[1], hand[2] + up];
    const elbow = view.elbow(place);
    const [x, y] = view.at(lifted);
    this.#arm.bend(view, view.shoulder, [elbow[0], elbow[1], elbow[2] + up / 2], lifted, place);
    set(this.#hand, { transform: `translate(${x.toFixed(2)} ${y.toFixed(2)})` });
    const [groundX, groundY] = view.at(place);
    set(this.#arrow, { transform: `translate(${groundX.toFixed(2)} ${groundY.toFixed(2)})` });
  }

  /** What the drawing shows, in words. */
  #say(state: number): void {
    this.#svg.setAttribute("aria-label", `A table from above. ${this.describe(state)}`);
  }

  /** Where the goals are, seen from the hand over `state`. */
  describe(state: number): string {
    const [right, ahead] = this.#at(state);
    const seen = this.#scene.goals.map(({ name, states }) => {
      const [goalRight, goalAhead] = this.#at(states[0] ?? 0);
      const across = Math.round(goalRight - right);
      const along = Math.round(goalAhead - ahead);
      const parts = [
        across === 0 ? "" : `${Math.abs(across)} ${across < 0 ? "left" : "right"}`,
        along === 0 ? "" : `${Math.abs(along)} ${along < 0 ? "back" : "forward"}`,
      ].filter(Boolean);
      return `${name}: ${parts.join(", ") || "here"}`;
    });
    return `From the hand to the goals, in steps: ${seen.join("; ")}.`;
  }
}
