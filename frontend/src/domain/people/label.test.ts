import { expect, test } from "vitest";
import { DEFAULT_LIMITS, whileUnheard } from "../fixes/staleness";
import { aNode, anAlarm, NOON, STOREYS } from "../samples";
import { type Labelled, labelWords } from "./label";

const ALL: Labelled = {
  now: NOON + 3,
  limits: DEFAULT_LIMITS,
  levels: STOREYS,
  level: "all",
  alarms: new Map(),
  narrow: false,
};
const upstairs = aNode({ level: 1, level_p: 0.99 });

test("a label says who, how old the fix is, and on which storey", () => {
  expect(labelWords(upstairs, ALL).whole).toEqual(["E7-1", "3 s · Level 1"]);
});

test("where there is no room it says who and how old, and a storey only if that is not sure", () => {
  expect(labelWords(upstairs, ALL).short).toBe("E7-1 · 3 s");
  expect(labelWords(aNode({ level: 1, level_p: 0.64 }), ALL).short).toBe("E7-1 · 3 s · Level 1, 64 %");
  expect(labelWords(upstairs, { ...ALL, now: NOON + 20 }).short).toBe("E7-1 · STALE 20 s");
  expect(labelWords(aNode({ level: 1, level_p: 0.64 }), ALL).brief).toBe("E7-1 · 3 s · storey?");
  expect(labelWords(upstairs, ALL).brief).toBe("E7-1 · 3 s");
});

test("a storey with a long name gives way in its middle, and its probability is said whole", () => {
  const levels = [{ level: 1, name: "Ground floor and mezzanine, east", up_m: 3 }];
  expect(labelWords(aNode({ level: 1, level_p: 0.64 }), { ...ALL, levels }).whole[1]).toBe(
    "3 s · Ground flo…nine, east, 64 %",
  );
});

test("on a phone's map it says that the storey is not sure, for which one there is no room", () => {
  const narrow = { ...ALL, narrow: true };
  expect(labelWords(aNode({ level: 1, level_p: 0.64 }), narrow).short).toBe("E7-1 · 3 s · storey?");
  expect(labelWords(upstairs, narrow).short).toBe("E7-1 · 3 s");
});

test("a storey that is not sure is said with its probability, also where that storey is shown", () => {
  const unsure = aNode({ level: 1, level_p: 0.64 });
  expect(labelWords(unsure, ALL).whole[1]).toBe("3 s · Level 1, 64 %");
  expect(labelWords(unsure, { ...ALL, level: 1 }).whole[1]).toBe("3 s · Level 1, 64 %");
});

test("whoever is on the storey that is shown needs no word on it", () => {
  expect(labelWords(upstairs, { ...ALL, level: 1 }).whole[1]).toBe("3 s");
});

test("who is in alarm on another storey than the one shown is labelled with his own", () => {
  const alarms = new Map([["ff1", anAlarm()]]);
  expect(labelWords(upstairs, { ...ALL, level: 0, alarms }).whole).toEqual(["E7-1 MAYDAY", "3 s · Level 1"]);
});

test("of who calls the storey is said though there is no room for it, but for the one that is shown", () => {
  const alarms = new Map([["ff1", anAlarm()]]);
  expect(labelWords(upstairs, { ...ALL, alarms }).short).toBe("E7-1 MAYDAY · 3 s · Level 1");
  expect(labelWords(upstairs, { ...ALL, alarms }).brief).toBe("E7-1 MAYDAY · 3 s");
  expect(labelWords(upstairs, { ...ALL, level: 1, alarms }).short).toBe("E7-1 MAYDAY · 3 s");
});

test("whose air is low is labelled with it, beside a call for help as well", () => {
  const low = aNode({ air_state: "low", air_bar: 48 });
  expect(labelWords(low, ALL).whole[0]).toBe("E7-1 LOW AIR");
  expect(labelWords(low, ALL).short).toBe("E7-1 LOW AIR · 3 s");
  expect(labelWords(low, { ...ALL, alarms: new Map([["ff1", anAlarm()]]) }).whole[0]).toBe(
    "E7-1 MAYDAY LOW AIR",
  );
});

test("what flies is on no storey", () => {
  expect(labelWords(aNode({ role: "uav", level: 1 }), ALL).whole[1]).toBe("3 s");
});

test("what is no longer live says so, and nothing is while the server is not heard", () => {
  expect(labelWords(upstairs, { ...ALL, now: NOON + 20 }).whole[1]).toBe("STALE 20 s · Level 1");
  expect(labelWords(upstairs, { ...ALL, limits: whileUnheard(DEFAULT_LIMITS) }).whole[1]).toBe(
    "STALE 3 s · Level 1",
  );
});

test("an age stays behind a name that is written from the right", () => {
  const david = aNode({ callsign: "דוד", level: 1, level_p: 0.99 });
  expect(labelWords(david, ALL).short).toBe("\u2068דוד\u2069 · 3 s");
});

test("a long name gives way in its middle, not to the age", () => {
  const { whole, short } = labelWords(aNode({ callsign: "Hauptlöschgruppenführer Wolkenstein" }), ALL);
  expect(whole[0]).toBe("Hauptlösch…olkenstein");
  expect(short).toBe("Hauptlösch…olkenstein · 3 s");
});

test("of who calls for help and is not tracked any more it is said that he is not", () => {
  const alarms = new Map([["ff1", anAlarm()]]);
  const gone = aNode({ level: 1, level_p: 0.99, status: "retired" });
  expect(labelWords(gone, { ...ALL, alarms }).short).toBe("E7-1 MAYDAY · NOT TRACKED 3 s · Level 1");
});

test("of whom it is not seen on the map how far off he may be, it is said, also where there is no room", () => {
  const { whole, short } = labelWords(upstairs, ALL, 196.2);
  expect(whole).toEqual(["E7-1", "3 s · ± 196 m · Level 1"]);
  expect(short).toBe("E7-1 · 3 s · ± 196 m");
  expect(labelWords(upstairs, ALL, 38.8).short).toBe("E7-1 · 3 s · ± 39 m");
});
