// How to steer, in words.

import { named } from "./directions";
import type { Device, Steering } from "./messages";

const HOLDING: Readonly<Record<Device, string>> = {
  keyboard: "Hold an arrow key to move the hand, or W, A, S and D.",
  gamepad: "Hold the stick or the cross to move the hand.",
  touch: "Press and hold an arrow to move the hand.",
  switch: "The directions light up in turn. Press your switch when the one you want is lit.",
};

const FIRST = "First click in the box, or press Tab until it is outlined.";

const TRYING: Readonly<Record<Device, string>> = {
  keyboard: `${FIRST} Then press each arrow key once; W, A, S and D do the same.`,
  gamepad: "Press any button of your gamepad, then push it once in each direction.",
  touch: "Press each arrow once.",
  switch:
    `${FIRST} The directions light up in turn. Press the space bar, or click in the box, when one ` +
    "is lit. Do so once for each.",
};

export function howToSteer(device: Device, inputs: readonly Steering[]): string {
  return HOLDING[device] + others(device, inputs);
}

export function howToTry(device: Device, inputs: readonly Steering[]): string {
  return TRYING[device] + others(device, inputs);
}

/** What gives the inputs that have no direction. */
function others(device: Device, inputs: readonly Steering[]): string {
  if (device !== "keyboard" && device !== "gamepad") return "";
  const what = device === "keyboard" ? "Key" : "Button";
  return named(inputs.map(({ direction }) => direction))
    .map((i, k) => ` ${what} ${k + 1} is for “${inputs[i]?.name ?? ""}”.`)
    .join("");
}
