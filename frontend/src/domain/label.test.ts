import { expect, test } from "vitest";
import { type Labelled, labelLines } from "./label";
import { aNode, anAlarm, NOON, STOREYS } from "./samples";
import { DEFAULT_LIMITS, whileUnheard } from "./staleness";

const ALL: Labelled = {
  now: NOON + 3,
  limits: DEFAULT_LIMITS,
  levels: STOREYS,
  level: "all",
  alarms: new Map(),
};
const upstairs = aNode({ level: 1, level_p: 0.99 });

test("a label says who, how old the fix is, and on which storey", () => {
  expect(labelLines(upstairs, ALL)).toEqual(["E7-1", "3 s · Level 1"]);
});

test("a storey that is not sure is said with its probability, also where that storey is shown", () => {
  const unsure = aNode({ level: 1, level_p: 0.64 });
  expect(labelLines(unsure, ALL)[1]).toBe("3 s · Level 1, 64 %");
  expect(labelLines(unsure, { ...ALL, level: 1 })[1]).toBe("3 s · Level 1, 64 %");
});

test("whoever is on the storey that is shown needs no word on it", () => {
  expect(labelLines(upstairs, { ...ALL, level: 1 })[1]).toBe("3 s");
});

test("who is in alarm on another storey than the one shown is labelled with his own", () => {
  const alarms = new Map([["ff1", anAlarm()]]);
  expect(labelLines(upstairs, { ...ALL, level: 0, alarms })).toEqual(["E7-1 MAYDAY", "3 s · Level 1"]);
});

test("what flies is on no storey", () => {
  expect(labelLines(aNode({ role: "uav", level: 1 }), ALL)[1]).toBe("3 s");
});

test("what is no longer live says so, and nothing is while the server is not heard", () => {
  expect(labelLines(upstairs, { ...ALL, now: NOON + 20 })[1]).toBe("STALE 20 s · Level 1");
  expect(labelLines(upstairs, { ...ALL, limits: whileUnheard(DEFAULT_LIMITS) })[1]).toBe(
    "STALE 3 s · Level 1",
  );
});
