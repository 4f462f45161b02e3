// The devices of the page: their events and readings become what is held.

import type { Vector } from "./directions";
import { Pad, STANDARD, type Layout } from "./gamepads";
import type { Held } from "./held";
import { Keys } from "./keys";
import { now } from "./messages";
import { Scanner } from "./scanner";
import type { Settings } from "./settings";

/** Milliseconds between looks at the gamepads. No frame of the screen is waited for. */
const POLL = 8;

/** Milliseconds between looks at the clock of the scan. */
const SCAN = 30;

const TYPING = "input, select, textarea, summary";

/** Keys that press the one switch. */
const SWITCHES = new Set(["Space", "Enter", "NumpadEnter"]);

function elsewhere(event: Event): boolean {
  return event.target instanceof Element && event.target.closest(TYPING) !== null;
}

/** Arrow keys, WASD and digits, while the focus is within `target`. */
export function watchKeyboard(
  target: HTMLElement | Window,
  directions: readonly Vector[],
  held: Held,
): void {
  const keys = new Keys(directions);
  const tell = () => held.set("keyboard", keys.input);
  const down = (event: Event) => {
    if (!(event instanceof KeyboardEvent) || elsewhere(event)) return;
    if (event.ctrlKey || event.altKey || event.metaKey || !keys.steers(event.code)) return;
    event.preventDefault();
    if (event.repeat) return;
    keys.press(event.code);
    tell();
  };
  target.addEventListener("keydown", down);
  window.addEventListener("keyup", (event) => {
    keys.release(event.code);
    tell();
  });
  onLeaving(() => {
    keys.clear();
    tell();
  });
}

/** The layout that `pad` is read by: a learnt one, or that of the browser, or none. */
export function layoutOf(pad: Gamepad, settings: Settings): Layout | null {
  return settings.layouts[pad.id] ?? (pad.mapping === "standard" ? STANDARD : null);
}

/** The gamepads that are there. */
export function gamepads(): Gamepad[] {
  return (navigator.getGamepads?.() ?? []).filter((pad) => pad !== null && pad.connected) as Gamepad[];
}

/** All gamepads; `seen` is shown each one at each look. */
export function watchGamepads(
  directions: readonly Vector[],
  settings: Settings,
  held: Held,
  seen: (pad: Gamepad) => void = () => undefined,
): void {
  const pads = new Map<number, Pad>();
  window.setInterval(() => {
    let input: number | null = null;
    let time: number | null = null;
    for (const gamepad of gamepads()) {
      seen(gamepad);
      const layout = layoutOf(gamepad, settings);
      if (!layout) continue;
      const pad = pads.get(gamepad.index) ?? new Pad(directions);
      pads.set(gamepad.index, pad);
      input = pad.read(layout, gamepad, settings.deadZone) ?? input;
      if (gamepad.timestamp > 0) time = Math.max(time ?? 0, gamepad.timestamp / 1000);
    }
    held.set("gamepad", document.hidden ? null : input, time);
  }, POLL);
}

/** One switch: a key, or a click anywhere but on what the page has for clicking. */
export function watchSwitch(
  target: HTMLElement | Window,
  count: number,
  settings: Settings,
  wait: boolean,
  held: Held,
  lit: (input: number | null) => void,
): { stop(): void } {
  const mode = () => (wait ? "hold" : settings.scanMode);
  const scanner = new Scanner(count, settings.scanSeconds, mode());
  let stopped = false;
  const tell = () => {
    held.set("switch", stopped ? null : scanner.held);
    lit(stopped ? null : scanner.lit);
  };
  const press = (event: Event) => {
    if (stopped || elsewhere(event) || clickable(event)) return;
    if (event instanceof KeyboardEvent && (!SWITCHES.has(event.code) || event.repeat)) return;
    event.preventDefault();
    scanner.press(now());
    tell();
  };
  const release = () => {
    scanner.release(now());
    tell();
  };
  target.addEventListener("keydown", press);
  target.addEventListener("pointerdown", press);
  for (const name of ["keyup", "pointerup", "pointercancel"]) window.addEventListener(name, release);
  onLeaving(() => {
    scanner.clear(now());
    tell();
  });
  window.setInterval(() => {
    scanner.adjust(settings.scanSeconds, mode());
    scanner.tick(now());
    tell();
  }, SCAN);
  return {
    stop() {
      stopped = true;
      tell();
    },
  };
}

function clickable(event: Event): boolean {
  return event.target instanceof Element && event.target.closest("a, button, label") !== null;
}

/** What is held is let go of when the page is left: its release would not be seen. */
function onLeaving(leave: () => void): void {
  window.addEventListener("blur", leave);
  document.addEventListener("visibilitychange", () => {
    if (document.hidden) leave();
  });
}
