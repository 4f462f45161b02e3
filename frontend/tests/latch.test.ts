import assert from "node:assert/strict";
import { test } from "node:test";
import { Latch } from "../src/latch";

function recorded(): [Latch<{ input: number | null; time: number }>, string[]] {
  const sent: string[] = [];
  const latch = new Latch<{ input: number | null; time: number }>(({ input, time }) =>
    sent.push(`${input}@${time}`),
  );
  return [latch, sent];
}

test("a tap is let go of once the robot has decided with it", () => {
  const [latch, sent] = recorded();
  latch.change({ input: 1, time: 0.1 });
  latch.change({ input: null, time: 0.2 });
  assert.deepEqual(sent, ["1@0.1"]);
  // This decision was on its way before the tap.
  latch.decided(null);
  assert.deepEqual(sent, ["1@0.1"]);
  latch.decided(1);
  assert.deepEqual(sent, ["1@0.1", "null@0.2"]);
});

test("an input that the robot has decided with is let go of at once", () => {
  const [latch, sent] = recorded();
  latch.change({ input: 1, time: 0.1 });
  latch.decided(1);
  latch.decided(1);
  latch.change({ input: null, time: 1.2 });
  assert.deepEqual(sent, ["1@0.1", "null@1.2"]);
});

test("another tap follows with both messages in their order", () => {
  const [latch, sent] = recorded();
  latch.change({ input: 1, time: 0.1 });
  latch.change({ input: null, time: 0.2 });
  latch.change({ input: 2, time: 0.3 });
  assert.deepEqual(sent, ["1@0.1", "null@0.2", "2@0.3"]);
  latch.change({ input: null, time: 0.4 });
  latch.decided(2);
  assert.deepEqual(sent.at(-1), "null@0.4");
});

test("a new attempt forgets what was under way", () => {
  const [latch, sent] = recorded();
  latch.change({ input: 1, time: 0.1 });
  latch.change({ input: null, time: 0.2 });
  latch.reset();
  latch.decided(1);
  assert.deepEqual(sent, ["1@0.1"]);
});
