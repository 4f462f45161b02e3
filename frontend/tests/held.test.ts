import assert from "node:assert/strict";
import { test } from "node:test";
import { Held, type Holding } from "../src/held";

function recorded(): [Held, Holding[]] {
  const told: Holding[] = [];
  return [new Held((holding) => told.push(holding)), told];
}

test("every change is told once, with its device", () => {
  const [held, told] = recorded();
  held.set("gamepad", 1, 12.5);
  held.set("gamepad", 1, 12.6);
  held.set("gamepad", null, 12.7);
  held.set("gamepad", null, 12.8);
  assert.deepEqual(told, [
    { input: 1, device: "gamepad", deviceTime: 12.5 },
    { input: null, device: "gamepad", deviceTime: 12.7 },
  ]);
});

test("of two devices the latest counts, and the other one comes back", () => {
  const [held, told] = recorded();
  held.set("keyboard", 0);
  held.set("touch", 2);
  held.set("keyboard", null);
  held.set("keyboard", 0);
  held.set("keyboard", null);
  assert.deepEqual(
    told.map(({ input, device }) => [input, device]),
    [
      [0, "keyboard"],
      [2, "touch"],
      [0, "keyboard"],
      [2, "touch"],
    ],
  );
});

test("what is held when an attempt begins counts once it has been let go of", () => {
  const [held, told] = recorded();
  held.set("gamepad", 1);
  held.reset();
  assert.equal(held.input, null);
  held.set("gamepad", 1);
  held.set("gamepad", 2);
  assert.equal(told.length, 1);
  held.set("gamepad", null);
  held.set("gamepad", 2);
  assert.equal(held.input, 2);
});
