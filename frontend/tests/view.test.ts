import assert from "node:assert/strict";
import { test } from "node:test";
import { CELL, raised, View, type Place } from "../src/view";

/** A grid as of table clearing, with cells of some size. */
function grid(columns: number, rows: number, size = 1): View {
  const positions: [number, number][] = [];
  const free: [number, number][] = [];
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      const state = positions.push([column * size, row * size]) - 1;
      if (column) free.push([state - 1, state]);
      if (row) free.push([state - columns, state]);
    }
  }
  return new View({ positions, free });
}

function near(a: readonly number[], b: readonly number[]): void {
  a.forEach((value, i) => assert.ok(Math.abs(value - (b[i] ?? Number.NaN)) < 1e-6, `${a} ${b}`));
}

test("left and right look alike: the arm hints at neither", () => {
  const view = grid(13, 4);
  for (const [right, ahead] of view.places) {
    const mirrored: Place = [12 - right, ahead, 0];
    const [x, y] = view.at(view.elbow([right, ahead, 0]));
    const [mirroredX, mirroredY] = view.at(view.elbow(mirrored));
    near([x, y], [view.width - mirroredX, mirroredY]);
  }
});

test("everything is within the drawing", () => {
  for (const view of [grid(13, 4), grid(11, 1), grid(3, 3), grid(5, 12), grid(4, 4, 0.1)]) {
    for (const place of view.places) {
      for (const shown of [place, raised(place), view.elbow(place), view.shoulder]) {
        const [x, y] = view.at(shown);
        assert.ok(x > 0 && x < view.width && y > 0 && y < view.height, `${shown} at ${x}, ${y}`);
      }
    }
  }
});

test("neighbours are a cell apart, whatever the unit of the positions", () => {
  for (const size of [1, 0.1, 25]) {
    const view = grid(6, 2, size);
    const [a, b] = [view.places[0], view.places[1]];
    assert.ok(a && b);
    near([view.at(b)[0] - view.at(a)[0]], [CELL]);
  }
});

test("what is farther ahead is higher up, and so is what is raised", () => {
  const view = grid(3, 3);
  assert.ok(view.at([1, 2, 0])[1] < view.at([1, 1, 0])[1]);
  assert.ok(view.at(raised([1, 1, 0]))[1] < view.at([1, 1, 0])[1]);
});
