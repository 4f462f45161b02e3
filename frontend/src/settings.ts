// How the controls react. Kept in the tab for the session; the server is told at every attempt.

import type { Layout } from "./gamepads";
import type { ScanMode } from "./scanner";

export interface Settings {
  /** Seconds for which each input is lit. */
  scanSeconds: number;
  scanMode: ScanMode;
  /** The least push of a stick that counts, from 0 to 1. */
  deadZone: number;
  /** Learnt layouts of gamepads, by what they call themselves. */
  layouts: Record<string, Layout>;
}

const NAME = "coadapt.settings";

const DEFAULTS: Settings = { scanSeconds: 1.2, scanMode: "hold", deadZone: 0.35, layouts: {} };

export function loadSettings(): Settings {
  try {
    const kept = JSON.parse(sessionStorage.getItem(NAME) ?? "{}") as Partial<Settings>;
    return { ...DEFAULTS, ...kept };
  } catch {
    // The browser keeps nothing for this page, or somebody changed it.
    return { ...DEFAULTS };
  }
}

export function saveSettings(settings: Settings): void {
  try {
    sessionStorage.setItem(NAME, JSON.stringify(settings));
  } catch {
    // They hold for this page alone.
  }
}

/** Show what of `settings` is for `device` in the page's form, and keep what is changed there. */
export function bindSettings(settings: Settings, device: string, wait: boolean): void {
  const box = document.getElementById("settings");
  if (!box) return;
  let some = false;
  for (const part of box.querySelectorAll<HTMLElement>("[data-for]")) {
    const pointless = wait && part.querySelector("[name=scan-mode]") !== null;
    part.hidden = part.dataset["for"] !== device || pointless;
    some ||= !part.hidden;
  }
  box.hidden = !some;
  range("scan-seconds", settings.scanSeconds, (value) => (settings.scanSeconds = value));
  range("dead-zone", 100 * settings.deadZone, (value) => (settings.deadZone = value / 100));
  for (const radio of box.querySelectorAll<HTMLInputElement>("[name=scan-mode]")) {
    radio.checked = radio.value === settings.scanMode;
    radio.onchange = () => {
      settings.scanMode = radio.value === "click" ? "click" : "hold";
      saveSettings(settings);
    };
  }

  function range(id: string, value: number, changed: (value: number) => void): void {
    const slider = document.getElementById(id) as HTMLInputElement | null;
    const shown = document.getElementById(`${id}-shown`);
    if (!slider || !shown) return;
    slider.value = String(value);
    shown.textContent = slider.value;
    slider.oninput = () => {
      shown.textContent = slider.value;
      changed(Number(slider.value));
      saveSettings(settings);
    };
  }
}
