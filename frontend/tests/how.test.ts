import assert from "node:assert/strict";
import { test } from "node:test";
import { howToSteer, howToTry } from "../src/how";
import type { Device, Steering } from "../src/messages";

const INPUTS: Steering[] = [
  { name: "left", direction: [-1, 0] },
  { name: "wait", direction: [0, 0] },
];

test("each device has its words, and keys or buttons for inputs without a direction", () => {
  const devices: Device[] = ["keyboard", "gamepad", "touch", "switch"];
  assert.equal(new Set(devices.map((device) => howToSteer(device, INPUTS))).size, 4);
  assert.equal(new Set(devices.map((device) => howToTry(device, INPUTS))).size, 4);
  assert.match(howToSteer("keyboard", INPUTS), /Key 1 is for “wait”\.$/);
  assert.match(howToTry("gamepad", INPUTS), /Button 1 is for “wait”\.$/);
  assert.doesNotMatch(howToSteer("touch", INPUTS), /wait/);
});
