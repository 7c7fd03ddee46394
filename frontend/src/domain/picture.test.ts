import { expect, test } from "vitest";
import { pictureOf, withDelta } from "./picture";
import { A_BREAK, A_DELAY, aDelta, aFrame, aNode, anAlarm, NOON } from "./samples";

const before = pictureOf(
  aFrame([aNode(), aNode({ node: "ff2", callsign: "E7-2" })], { alarms: [anAlarm()] }),
);

test("a delta replaces the nodes it names whole and leaves the others", () => {
  const after = withDelta(before, aDelta([aNode({ callsign: null, position_m: [5, 6, 7] })]));
  expect(after.nodes.get("ff1")?.state).toMatchObject({ callsign: null, position_m: [5, 6, 7] });
  expect(after.nodes.get("ff2")).toBe(before.nodes.get("ff2"));
  expect(after.seq).toBe(2);
});

test("a node remembers when the server presented it", () => {
  const after = withDelta(before, aDelta([aNode()], { clock_t: NOON + 4 }));
  expect(after.nodes.get("ff1")?.presentedT).toBe(NOON + 4);
  expect(after.nodes.get("ff2")?.presentedT).toBe(NOON);
});

test("a delta's alarms are all that stand", () => {
  expect(before.alarms).toHaveLength(1);
  expect(withDelta(before, aDelta([])).alarms).toEqual([]);
});

test("a delta introduces a node that was not known", () => {
  expect([...withDelta(before, aDelta([aNode({ node: "b1" })])).nodes.keys()]).toEqual(["ff1", "ff2", "b1"]);
});

test("a picture stands still as long as the server says that the estimator could not go on", () => {
  const still = withDelta(before, aDelta([], { notices: [A_BREAK] }));
  expect([before.standsStill, still.standsStill, withDelta(still, aDelta([])).standsStill]).toEqual([
    false,
    true,
    false,
  ]);
});

test("a picture is behind as long as the server says that something reported is not in it", () => {
  const behind = withDelta(before, aDelta([], { notices: [A_DELAY] }));
  expect([before.behind, behind.behind, withDelta(behind, aDelta([])).behind]).toEqual([false, true, false]);
});

test("the picture before a delta stays as it was", () => {
  withDelta(before, aDelta([aNode({ position_m: [9, 9, 9] })]));
  expect(before.nodes.get("ff1")?.state.position_m).toEqual([0, 0, 0]);
});
