// The researcher's replay of an attempt. The page has an element with the id "replay" and, within it
// or at the address of its `data-source`, a recording as JSON.

import { Arena } from "./arena";
import { Beliefs } from "./beliefs";
import type { Scene, Step } from "./messages";
import { element } from "./shapes";

type Belief = number[][];

/** One step, with what the robot believed when it decided. */
interface RecordedStep extends Step {
  /** Seconds since the attempt began. */
  time: number;
  action: number | null;
  planned: number | null;
  matched: boolean | null;
  belief: Belief | null;
}

export interface Recording {
  scene: Scene;
  /** The state in which the attempt began. */
  start: number;
  /** The values of adaptability, the names of the modes and of the robot's actions. */
  adaptability: number[];
  modes: string[];
  actions: string[];
  steps: RecordedStep[];
  /** The goal reached, if any. */
  goal: number | null;
}

class Replay {
  readonly #recording: Recording;
  readonly #arena: Arena;
  readonly #beliefs: Beliefs | null;
  readonly #slider: HTMLInputElement;
  readonly #play = element("button", { type: "button" }, "Play");
  readonly #words = element("p", { role: "status" });
  #timer: number | undefined;

  constructor(parent: HTMLElement, recording: Recording) {
    this.#recording = recording;
    const drawing = element("div", { class: "stage" });
    const beside = element("div", { class: "beliefs" });
    const last = recording.steps.length;
    const label = element("label", { for: "replay-step" }, "Step");
    this.#slider = element("input", { type: "range", id: "replay-step", min: 0, max: last, value: 0 });
    const controls = element("div", { class: "controls" }, this.#play, label, this.#slider);
    parent.append(drawing, controls, this.#words, beside);
    this.#arena = new Arena(drawing, recording.scene);
    const known = recording.steps.some(({ belief }) => belief !== null);
    this.#beliefs = known ? new Beliefs(beside, recording.adaptability, recording.modes) : null;
    this.#slider.oninput = () => this.#halt(() => this.#show(Number(this.#slider.value), 0));
    this.#play.onclick = () => (this.#timer === undefined ? this.#run() : this.#halt());
    this.#show(0, 0);
  }

  /** Show the attempt after `count` steps; the last of them takes `seconds`. */
  #show(count: number, seconds: number): void {
    const { steps, start, scene, actions, goal } = this.#recording;
    const step = steps[count - 1];
    this.#slider.value = String(count);
    if (!step) {
      this.#arena.show(start);
      this.#arena.input(null);
      this.#words.textContent = `Before the first of ${steps.length} steps.`;
      return;
    }
    if (seconds === 0) this.#arena.show(step.state);
    this.#arena.input(step.input);
    this.#arena.step(step, seconds);
    if (step.belief) this.#beliefs?.show(step.belief);
    const name = (index: number | null, names: readonly string[]) =>
      index === null ? "none" : (names[index] ?? String(index));
    const inputs = scene.inputs.map((input) => input.name);
    const planned = step.planned === null ? "" : `, planned ${name(step.planned, actions)}`;
    const matched = step.matched ? " (the match rule took the input)" : "";
    this.#words.textContent =
      `Step ${count} of ${steps.length}, ${step.time.toFixed(2)} s: ` +
      `input ${name(step.input, inputs)}${planned}, action ${name(step.action, actions)}${matched}.`;
    if (count === steps.length && seconds > 0) void this.#arena.finish(goal);
  }

  #run(): void {
    const { scene, steps } = this.#recording;
    let count = Number(this.#slider.value);
    if (count >= steps.length) this.#show((count = 0), 0);
    this.#play.textContent = "Pause";
    const next = () => {
      count += 1;
      if (count > steps.length) {
        this.#halt();
        return;
      }
      this.#show(count, scene.step);
      this.#timer = window.setTimeout(next, 1000 * scene.step);
    };
    next();
  }

  #halt(then: () => void = () => undefined): void {
    window.clearTimeout(this.#timer);
    this.#timer = undefined;
    this.#play.textContent = "Play";
    then();
  }
}

/** Show `recording` in `parent`. */
export function replay(parent: HTMLElement, recording: Recording): void {
  new Replay(parent, recording);
}

async function begin(parent: HTMLElement): Promise<void> {
  const within = parent.querySelector('script[type="application/json"]');
  const source = parent.dataset["source"];
  if (within) {
    replay(parent, JSON.parse(within.textContent ?? "") as Recording);
  } else if (source) {
    const answer = await fetch(source, { credentials: "same-origin" });
    if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
    replay(parent, (await answer.json()) as Recording);
  }
}

const parent = document.getElementById("replay");
if (parent) {
  begin(parent).catch((error: unknown) => {
    parent.append(element("p", { class: "problem", role: "alert" }, `No replay: ${String(error)}`));
  });
}
