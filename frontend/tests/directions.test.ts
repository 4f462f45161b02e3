import assert from "node:assert/strict";
import { test } from "node:test";
import { named, nearest, type Vector } from "../src/directions";

const THREE: Vector[] = [
  [-1, 0],
  [0, 1],
  [1, 0],
];

const EIGHT: Vector[] = Array.from({ length: 8 }, (_, i) => [
  Math.cos((i * Math.PI) / 4),
  Math.sin((i * Math.PI) / 4),
]);

function towards(degrees: number): Vector {
  return [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
}

test("the nearest direction is taken", () => {
  for (let degrees = 0; degrees < 360; degrees += 1) {
    if (degrees % 45 === 22.5) continue;
    assert.equal(nearest(EIGHT, towards(degrees)), Math.round(degrees / 45) % 8);
  }
});

test("a push away from all of them is none", () => {
  assert.equal(nearest(THREE, [0, -1]), null);
  assert.equal(nearest(THREE, towards(-59)), 2);
  assert.equal(nearest(THREE, towards(-61)), null);
  assert.equal(nearest(THREE, [0, 0]), null);
});

test("of two that are about as near, the held one stays", () => {
  assert.equal(nearest(THREE, towards(47), 2), 2);
  assert.equal(nearest(THREE, towards(47), 1), 1);
  assert.equal(nearest(THREE, towards(47)), 1);
  assert.equal(nearest(THREE, towards(60), 2), 1);
});

test("inputs without a direction are never the nearest", () => {
  const some: Vector[] = [
    [-1, 0],
    [0, 0],
    [1, 0],
  ];
  assert.deepEqual(named(some), [1]);
  assert.equal(nearest(some, [0, 1]), null);
});
