import assert from "node:assert/strict";
import { test } from "node:test";
import { Calibration } from "../src/calibration";
import type { Vector } from "../src/directions";
import { Pad, STANDARD, type Reading } from "../src/gamepads";

const [LEFT, FORWARD, RIGHT] = [0, 1, 2];
const THREE: Vector[] = [
  [-1, 0],
  [0, 1],
  [1, 0],
];
const DEAD = 0.35;

function reading(axes: number[], ...pressed: number[]): Reading {
  const buttons = Array.from({ length: 16 }, (_, i) => {
    const down = pressed.includes(i);
    return { pressed: down, value: down ? 1 : 0 };
  });
  return { axes, buttons };
}

test("sticks and cross of a standard pad", () => {
  const pad = new Pad(THREE);
  const read = (made: Reading) => pad.read(STANDARD, made, DEAD);
  assert.equal(read(reading([0, 0, 0, 0])), null);
  assert.equal(read(reading([-0.9, 0.1, 0, 0])), LEFT);
  assert.equal(read(reading([0, 0, 0, -1])), FORWARD);
  assert.equal(read(reading([0, 0, 0, 0], 15)), RIGHT);
  assert.equal(read(reading([0, 0, 0, 0], 13)), null);
  assert.equal(read(reading([0, 0, 0, 0], 0)), null);
});

test("a trembling stick does not let go at the edge of the dead zone", () => {
  const pad = new Pad(THREE);
  const at = (value: number) => pad.read(STANDARD, reading([value, 0, 0, 0]), DEAD);
  assert.equal(at(DEAD - 0.01), null);
  assert.equal(at(DEAD + 0.01), RIGHT);
  assert.equal(at(DEAD - 0.05), RIGHT);
  assert.equal(at(0.8 * DEAD - 0.01), null);
  assert.equal(at(DEAD - 0.05), null);
});

test("a stick on the way between two directions changes once", () => {
  const pad = new Pad(THREE);
  const at = (degrees: number) => {
    const angle = (degrees * Math.PI) / 180;
    return pad.read(STANDARD, reading([Math.cos(angle), -Math.sin(angle), 0, 0]), DEAD);
  };
  assert.equal(at(0), RIGHT);
  assert.equal(at(46), RIGHT);
  assert.equal(at(50), FORWARD);
  assert.equal(at(44), FORWARD);
  assert.equal(at(38), RIGHT);
});

test("buttons give the inputs that have no direction", () => {
  const pad = new Pad([
    [-1, 0],
    [0, 0],
    [1, 0],
  ]);
  assert.equal(pad.read(STANDARD, reading([0, 0, 0, 0], 0), DEAD), 1);
});

/** Go through a calibration on which each way reads as given. */
function calibrated(rest: Reading, pushes: Record<string, Reading>): Calibration {
  const calibration = new Calibration(["left", "forward", "right", "back"]);
  const last = (made: Reading) => {
    for (let i = 0; i < 10; i += 1) calibration.read(made);
  };
  for (let asked = calibration.asked; asked; asked = calibration.asked) {
    last(rest);
    last(pushes[asked] ?? rest);
    assert.notEqual(calibration.asked, asked);
    assert.equal(calibration.done, false);
  }
  last(rest);
  assert.equal(calibration.done, true);
  return calibration;
}

test("a stick on unknown axes, upside down and resting off its middle", () => {
  const rest = reading([0.5, 0, 0.1]);
  const { layout } = calibrated(rest, {
    left: reading([0.5, 0, 1]),
    right: reading([0.5, 0, -0.9]),
    forward: reading([0.5, 1, 0.1]),
    back: reading([0.5, -1, 0.1]),
  });
  const pad = new Pad(THREE);
  assert.equal(pad.read(layout, rest, DEAD), null);
  assert.equal(pad.read(layout, reading([0.5, 0, 0.8]), DEAD), LEFT);
  assert.equal(pad.read(layout, reading([0.5, 0, -0.7]), DEAD), RIGHT);
  assert.equal(pad.read(layout, reading([0.5, 0.9, 0.3]), DEAD), FORWARD);
  assert.equal(pad.read(layout, reading([0.5, -1, 0.1]), DEAD), null);
});

test("a cross that is reported as one axis", () => {
  // Chromium reports some hats so: eight values from -1 (forward) clockwise, and one off the scale.
  const hat = (value: number) => reading([0, 0, value]);
  const { layout } = calibrated(hat(1.2857), {
    left: hat(0.7143),
    right: hat(-0.4286),
    forward: hat(-1),
    back: hat(0.1429),
  });
  const pad = new Pad(THREE);
  assert.equal(pad.read(layout, hat(-1), DEAD), FORWARD);
  assert.equal(pad.read(layout, hat(0.7143), DEAD), LEFT);
  assert.equal(pad.read(layout, hat(-0.4286), DEAD), RIGHT);
  assert.equal(pad.read(layout, hat(0.1429), DEAD), null);
  assert.equal(pad.read(layout, hat(1.2857), DEAD), null);
});

test("buttons for ways, and the same push is not taken for two ways", () => {
  const rest = reading([0, 0]);
  const calibration = new Calibration(["left", "right"]);
  const last = (made: Reading) => {
    for (let i = 0; i < 20; i += 1) calibration.read(made);
  };
  last(rest);
  last(reading([0, 0], 7));
  assert.equal(calibration.asked, "right");
  assert.equal(calibration.letGo, true);
  last(rest);
  last(reading([0, 0], 7));
  assert.equal(calibration.asked, "right");
  last(rest);
  last(reading([0, 0], 8));
  assert.equal(calibration.asked, null);
  const pad = new Pad(THREE);
  assert.equal(pad.read(calibration.layout, reading([0, 0], 8), DEAD), RIGHT);
});

test("a short jerk is no push", () => {
  const calibration = new Calibration(["left"]);
  for (let i = 0; i < 20; i += 1) calibration.read(reading([i % 2 ? -1 : 0, 0]));
  assert.equal(calibration.asked, "left");
});
