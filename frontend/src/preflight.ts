// The page on which the controls are tried and the connection is measured.

import { Buttons } from "./buttons";
import { Calibration } from "./calibration";
import { Connection } from "./connection";
import { gamepads, layoutOf, watchGamepads, watchKeyboard, watchSwitch } from "./devices";
import { angle, length } from "./directions";
import { WAYS, type Way } from "./gamepads";
import { Held } from "./held";
import { howToTry } from "./how";
import type { Device, Steering } from "./messages";
import { bindSettings, loadSettings, saveSettings } from "./settings";
import { element } from "./shapes";

/** Round trips that the latency is the median of, and milliseconds between them. */
const TRIPS = 9;
const BETWEEN = 120;

/** A window narrower than this, in CSS pixels, is small. */
const NARROW = 320;

const INSECURE =
  "This page has not come over a secure connection (https), and browsers hide gamepads from such " +
  "pages. Please choose something else, or tell the researchers.";

function find<Kind extends HTMLElement>(id: string): Kind {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no ${id}`);
  return found as Kind;
}

class Preflight {
  readonly #form: HTMLFormElement;
  readonly #inputs: readonly Steering[];
  readonly #settings = loadSettings();
  readonly #tried = new Set<number>();
  readonly #held: Held;
  readonly #buttons: Buttons;
  readonly #box: HTMLElement;
  #device: Device | null = null;
  #pad: Gamepad | null = null;
  #calibration: Calibration | null = null;
  #latency: number | null = null;

  constructor(form: HTMLFormElement) {
    this.#form = form;
    this.#inputs = JSON.parse(find("inputs").textContent ?? "[]") as Steering[];
    this.#held = new Held(({ input, device }) => this.#push(input, device));
    this.#box = element("div", { class: "box", tabindex: 0, role: "group", "aria-label": "Try it here" });
    this.#buttons = new Buttons(
      this.#inputs,
      (input) => this.#held.set("touch", input),
      (input) => this.#held.set("keyboard", input),
    );
    this.#box.append(this.#buttons.element);
    find("trying-box").append(this.#box);
    this.#watch();
    this.#measureWindow();
    this.#measureConnection();
    for (const radio of form.querySelectorAll<HTMLInputElement>("[name=device]")) {
      radio.addEventListener("change", () => this.#choose(radio.value as Device));
      if (radio.checked) this.#choose(radio.value as Device);
    }
    form.addEventListener("submit", (event) => this.#submit(event));
  }

  #watch(): void {
    const directions = this.#inputs.map(({ direction }) => direction);
    watchKeyboard(this.#box, directions, this.#held);
    watchGamepads(directions, this.#settings, this.#held, (pad) => this.#see(pad));
    const lit = (input: number | null) => this.#buttons.scan(this.#device === "switch" ? input : null);
    watchSwitch(this.#box, directions.length, this.#settings, false, this.#held, lit);
  }

  #choose(device: Device): void {
    this.#device = device;
    this.#tried.clear();
    this.#buttons.untry();
    this.#buttons.tabbed = device === "touch";
    this.#buttons.inert = device === "switch";
    // Only the devices that need the focus can have it: with the others there is nothing to type.
    const focus = device === "keyboard" || device === "switch";
    if (focus) this.#box.tabIndex = 0;
    else this.#box.removeAttribute("tabindex");
    find("trying").hidden = false;
    find("trying-how").textContent = howToTry(device, this.#inputs);
    const warning = find("trying-warning");
    warning.hidden = device !== "gamepad" || window.isSecureContext;
    warning.textContent = INSECURE;
    bindSettings(this.#settings, device, false);
    this.#checkDevice();
    if (device === "gamepad") this.#lookForPad();
  }

  #lookForPad(): void {
    const pads = gamepads();
    if (pads.length === 0) this.#status("No gamepad seen yet.");
  }

  /** A gamepad is there; one of unknown layout is calibrated. */
  #see(pad: Gamepad): void {
    if (this.#device !== "gamepad") return;
    if (this.#pad?.id !== pad.id) {
      this.#status(`Gamepad found: ${pad.id}`);
      if (!layoutOf(pad, this.#settings)) this.#calibration = new Calibration(this.#ways());
    }
    this.#pad = pad;
    const calibration = this.#calibration;
    if (!calibration) return;
    calibration.read(pad);
    const { asked, done, letGo } = calibration;
    if (done) {
      this.#settings.layouts[pad.id] = calibration.layout;
      saveSettings(this.#settings);
      this.#calibration = null;
      this.#held.reset();
      this.#status("Your gamepad is known now. Push it once in each direction.");
    } else if (letGo) {
      this.#status("Good. Now let go.");
    } else {
      this.#status(`Push the stick or the cross ${asked}, and hold it for a moment.`);
    }
  }

  /** The ways that are needed to give all inputs. */
  #ways(): Way[] {
    return (Object.keys(WAYS) as Way[]).filter((way) =>
      this.#inputs.some(
        ({ direction }) => length(direction) > 0 && angle(direction, WAYS[way]) < Math.PI / 2 - 0.1,
      ),
    );
  }

  #push(input: number | null, device: Device): void {
    if (device !== this.#device || this.#calibration) return;
    this.#buttons.hold(input);
    if (input === null) return;
    this.#tried.add(input);
    this.#buttons.tried(input);
    this.#checkDevice();
    const left = this.#inputs.length - this.#tried.size;
    this.#status(left === 0 ? "All directions work." : `“${this.#inputs[input]?.name}” works. ${left} to go.`);
  }

  get #works(): boolean {
    return this.#inputs.every((_, i) => this.#tried.has(i));
  }

  #checkDevice(): void {
    const text = this.#works ? "Controls: all directions work" : "Controls: not tried yet";
    this.#check("device", this.#works ? "good" : "", text);
  }

  #measureWindow(): void {
    const measure = () => {
      const { innerWidth: width, innerHeight: height } = window;
      const small = width < NARROW;
      const advice = small ? "; please make it larger if you can" : "";
      this.#check("window", small ? "bad" : "good", `Window: ${width} × ${height}${advice}`);
      this.#field("width", String(width));
      this.#field("height", String(height));
    };
    measure();
    window.addEventListener("resize", measure);
    this.#field("browser", navigator.userAgent.slice(0, 500));
  }

  #measureConnection(): void {
    const connection = new Connection(this.#form.dataset["socket"] ?? "", {
      message: () => this.#measured(connection),
      lost: () => this.#check("connection", "bad", "Connection: none yet, trying again …"),
    });
    const timer = window.setInterval(() => {
      if (connection.trips.length < TRIPS) connection.ping();
      else window.clearInterval(timer);
    }, BETWEEN);
  }

  #measured(connection: Connection): void {
    if (connection.trips.length < TRIPS || this.#latency !== null) return;
    const trips = [...connection.trips].sort((a, b) => a - b);
    this.#latency = trips[Math.floor(trips.length / 2)] ?? 0;
    this.#field("latency", this.#latency.toFixed(4));
    const shown = `${Math.max(1, Math.round(1000 * this.#latency))} ms there and back`;
    this.#check("connection", "good", `Connection: ${shown}`);
    connection.close();
  }

  #submit(event: Event): void {
    this.#field("pad", this.#device === "gamepad" ? (this.#pad?.id ?? "").slice(0, 500) : "");
    let problem = "";
    if (!this.#device) problem = "Please choose what you want to steer with.";
    else if (!this.#works) problem = "Please try each direction once, in the box above.";
    else if (this.#latency === null) problem = "Please wait a moment: the connection is measured.";
    const shown = find("not-yet");
    shown.textContent = problem;
    shown.hidden = problem === "";
    if (problem) event.preventDefault();
  }

  #field(name: string, value: string): void {
    const field = this.#form.elements.namedItem(name);
    if (field instanceof HTMLInputElement) field.value = value;
  }

  #check(name: string, mark: "good" | "bad" | "", text: string): void {
    const item = find(`check-${name}`);
    item.className = mark;
    const what = item.querySelector(".what");
    if (what) what.textContent = text;
  }

  #status(text: string): void {
    const status = find("trying-status");
    if (status.textContent !== text) status.textContent = text;
  }
}

const form = document.getElementById("preflight");
if (form instanceof HTMLFormElement) new Preflight(form);
