import assert from "node:assert/strict";
import { test } from "node:test";
import { Keys } from "../src/keys";
import type { Vector } from "../src/directions";

const [LEFT, FORWARD, RIGHT] = [0, 1, 2];
const THREE: Vector[] = [
  [-1, 0],
  [0, 1],
  [1, 0],
];

test("arrow keys and WASD are the same", () => {
  for (const [arrow, letter, input] of [
    ["ArrowLeft", "KeyA", LEFT],
    ["ArrowUp", "KeyW", FORWARD],
    ["ArrowRight", "KeyD", RIGHT],
  ] as const) {
    for (const code of [arrow, letter]) {
      const keys = new Keys(THREE);
      keys.press(code);
      assert.equal(keys.input, input);
      keys.release(code);
      assert.equal(keys.input, null);
    }
  }
});

test("of two keys for different inputs the latest wins, and the other one comes back", () => {
  const keys = new Keys(THREE);
  keys.press("ArrowLeft");
  keys.press("ArrowUp");
  assert.equal(keys.input, FORWARD);
  keys.release("ArrowUp");
  assert.equal(keys.input, LEFT);
  keys.press("ArrowRight");
  assert.equal(keys.input, RIGHT);
});

test("two keys make a diagonal where there is one", () => {
  const keys = new Keys([...THREE, [-1, 1]]);
  keys.press("ArrowLeft");
  keys.press("ArrowUp");
  assert.equal(keys.input, 3);
});

test("a key for no input gives none, and repeats count once", () => {
  const keys = new Keys(THREE);
  keys.press("ArrowDown");
  assert.equal(keys.input, null);
  assert.equal(keys.steers("KeyX"), false);
  keys.press("ArrowLeft");
  keys.press("ArrowLeft");
  keys.release("ArrowLeft");
  keys.clear();
  assert.equal(keys.input, null);
});

test("digits give the inputs that have no direction", () => {
  const keys = new Keys([
    [-1, 0],
    [0, 0],
    [1, 0],
    [0, 0],
  ]);
  keys.press("Digit2");
  assert.equal(keys.input, 3);
  assert.equal(keys.steers("Digit3"), false);
});
