// The page of a training session or a trial.

import { Arena } from "./arena";
import { Buttons } from "./buttons";
import { Connection } from "./connection";
import { watchGamepads, watchKeyboard, watchSwitch } from "./devices";
import { Held, type Holding } from "./held";
import { howToSteer } from "./how";
import { Latch } from "./latch";
import { now, type Device, type FromServer, type Scene } from "./messages";
import { bindSettings, loadSettings } from "./settings";
import { element } from "./shapes";

const BEGIN = "Push in any direction to begin";

/** After so many failed attempts to connect the page offers to be loaded again. */
const MANY_TRIES = 6;

type Timed = Holding & { pageTime: number };

class Steering {
  readonly #page: HTMLElement;
  readonly #device: Device;
  readonly #settings = loadSettings();
  readonly #connection: Connection;
  readonly #held = new Held((holding) => this.#changed(holding));
  readonly #latch = new Latch<Timed>((timed) => this.#tell(timed));
  readonly #stage = element("div", { class: "stage" });
  readonly #banner = element("p", { class: "banner", role: "status" });
  readonly #controls = element("div", { class: "controls" });
  readonly #unstored = new Set<number>();
  #scene: Scene | null = null;
  #arena: Arena | null = null;
  #buttons: Buttons | null = null;
  #switch: { stop(): void } | null = null;
  #sequence = 0;
  #steering = false;
  #lost = false;

  constructor(page: HTMLElement) {
    this.#page = page;
    this.#device = (page.dataset["device"] ?? "keyboard") as Device;
    const drawing = element("div");
    this.#stage.append(drawing, this.#banner);
    page.append(this.#stage, this.#controls);
    this.#say("Connecting …");
    this.#connection = new Connection(page.dataset["socket"] ?? "", {
      message: (message) => this.#hear(message),
      lost: (tries) => this.#gone(tries),
    });
    window.addEventListener("error", (event) => this.#note("error", null, event.message));
    window.addEventListener("unhandledrejection", (event) =>
      this.#note("error", null, String(event.reason)),
    );
  }

  #hear(message: FromServer): void {
    switch (message.type) {
      case "scene":
        this.#draw(message);
        this.#connection.send({ type: "ready" });
        break;
      case "begun":
        this.#begin(message.state, message.attempt);
        break;
      case "stored":
        this.#unstored.delete(message.sequence);
        break;
      case "step":
        this.#say("");
        this.#latch.decided(message.input);
        this.#arena?.step(message, this.#scene?.step ?? 0);
        break;
      case "over":
        this.#steering = false;
        void this.#end(message.goal);
        break;
      case "refused":
        this.#connection.close();
        this.#reload(message.reason);
        break;
      case "pong":
        break;
    }
  }

  /** At the first connection: the scene and the devices. The scene of a session never changes. */
  #draw(scene: Scene): void {
    if (this.#arena) return;
    const drawing = this.#stage.firstElementChild;
    if (!drawing) return;
    this.#scene = scene;
    this.#arena = new Arena(drawing, scene);
    const directions = scene.inputs.map(({ direction }) => direction);
    const wait = scene.turns === "wait";
    const buttons = new Buttons(
      scene.inputs,
      (input) => this.#held.set("touch", input),
      (input) => this.#held.set("keyboard", input),
    );
    this.#buttons = buttons;
    this.#controls.append(buttons.element, element("p", {}, howToSteer(this.#device, scene.inputs)));
    bindSettings(this.#settings, this.#device, wait);
    if (this.#device === "switch") {
      buttons.inert = true;
      const lit = (input: number | null) => buttons.scan(input);
      const { inputs } = scene;
      this.#switch = watchSwitch(window, inputs.length, this.#settings, wait, this.#held, lit);
    } else {
      watchKeyboard(window, directions, this.#held);
      watchGamepads(directions, this.#settings, this.#held);
    }
  }

  #begin(state: number, attempt: number): void {
    // What was under way when the connection was lost is void on both sides: nothing is sent again.
    if (this.#unstored.size) this.#note("unstored", this.#unstored.size, "");
    this.#unstored.clear();
    this.#held.reset();
    this.#latch.reset();
    this.#buttons?.hold(null);
    this.#arena?.input(null);
    this.#arena?.show(state);
    this.#steering = true;
    const again = this.#lost || attempt > 1 ? "This begins again from the start. " : "";
    this.#lost = false;
    this.#say(`${again}${BEGIN}`);
    const { scanSeconds, scanMode, deadZone } = this.#settings;
    this.#note("settings", null, JSON.stringify({ scanSeconds, scanMode, deadZone }));
  }

  #changed(holding: Holding): void {
    if (!this.#steering) return;
    this.#buttons?.hold(holding.input);
    const timed = { ...holding, pageTime: now() };
    if (this.#scene?.turns === "fixed") this.#latch.change(timed);
    else this.#tell(timed);
  }

  #tell({ input, device, deviceTime, pageTime }: Timed): void {
    this.#arena?.input(input);
    const sequence = this.#sequence++;
    const sent = this.#connection.send({
      type: "input",
      input,
      device,
      sequence,
      page_time: pageTime,
      device_time: deviceTime,
    });
    if (sent) this.#unstored.add(sequence);
  }

  #gone(tries: number): void {
    this.#steering = false;
    this.#lost ||= this.#arena !== null;
    this.#arena?.input(null);
    this.#buttons?.hold(null);
    if (tries >= MANY_TRIES) this.#reload("There is no connection to the study.", true);
    else this.#say("The connection is lost. Connecting again …", true);
  }

  async #end(goal: number | null): Promise<void> {
    const trips = [...this.#connection.trips].sort((a, b) => a - b);
    this.#note("latency", trips[Math.floor(trips.length / 2)] ?? null, "");
    this.#connection.close();
    this.#buttons?.hold(null);
    this.#say("");
    this.#switch?.stop();
    await this.#arena?.finish(goal);
    const name = goal === null ? null : this.#scene?.goals[goal]?.name;
    const what = name ? `Done: the robot has taken “${name}”.` : "The time for this task is over.";
    const onward = element("button", { type: "button" }, "Continue");
    onward.addEventListener("click", () => location.assign(this.#here));
    // A switch that is still held from the task must not press it.
    onward.addEventListener("keydown", (event) => {
      if (event.repeat) event.preventDefault();
    });
    const over = element("div", { class: "over" }, element("p", { role: "status" }, what), onward);
    this.#controls.replaceChildren(over);
    onward.focus();
    if (this.#switch) onSwitch(() => onward.click());
  }

  get #here(): string {
    return this.#page.dataset["page"] ?? location.pathname;
  }

  #say(text: string, lost = false): void {
    this.#banner.hidden = text === "";
    this.#banner.classList.toggle("lost", lost);
    if (this.#banner.textContent !== text) this.#banner.textContent = text;
  }

  #reload(reason: string, lost = true): void {
    this.#say(`${reason} `, lost);
    this.#banner.append(element("a", { href: this.#here }, "Load this page again"));
  }

  #note(what: string, value: number | null, text: string): void {
    this.#connection.send({ type: "note", what, value, text: text.slice(0, 500) });
  }
}

/** The next press of the switch, not the one that ended the trial, does `action`. */
function onSwitch(action: () => void): void {
  const since = now();
  window.addEventListener("pointerdown", (event) => {
    const other = event.target instanceof Element && event.target.closest("a, button, summary");
    if (!other && now() - since > 0.7) action();
  });
}

const page = document.getElementById("steer");
if (page) new Steering(page);
