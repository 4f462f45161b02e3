import assert from "node:assert/strict";
import { test } from "node:test";
import { Scanner } from "../src/scanner";

test("the inputs light up in turn, whenever one looks", () => {
  const scanner = new Scanner(3, 1, "hold");
  const lit = [0, 0.5, 1.01, 1.9, 2.1, 3.2, 7.3].map((time) => {
    scanner.tick(time);
    return scanner.lit;
  });
  assert.deepEqual(lit, [0, 0, 1, 1, 2, 0, 1]);
});

test("press and hold", () => {
  const scanner = new Scanner(3, 1, "hold");
  scanner.tick(0);
  scanner.press(1.5);
  assert.equal(scanner.held, 1);
  scanner.tick(9);
  assert.equal(scanner.lit, 1);
  scanner.release(9);
  assert.equal(scanner.held, null);
  scanner.tick(9.5);
  assert.equal(scanner.lit, 1);
  scanner.tick(10.5);
  assert.equal(scanner.lit, 2);
});

test("one press starts, the next one stops", () => {
  const scanner = new Scanner(3, 1, "click");
  scanner.tick(0);
  scanner.press(0.2);
  scanner.release(0.3);
  assert.equal(scanner.held, 0);
  scanner.press(4);
  scanner.release(4.1);
  assert.equal(scanner.held, null);
  scanner.adjust(0.5, "click");
  scanner.tick(4.6);
  assert.equal(scanner.lit, 1);
});
