import { expect, test } from "vitest";
import { aNode, STOREYS } from "./samples";
import type { Status } from "./types";
import * as words from "./words";

test.each([
  [0, "0 s ago"],
  [12.9, "12 s ago"],
  [185, "3 min 05 s ago"],
  [7440, "2 h 04 min ago"],
  [-4, "0 s ago"],
])("an age of %d s reads %s", (age, text) => {
  expect(words.agoWords(age)).toBe(text);
});

test.each([
  [119, "119 s"],
  [120, "2 min"],
  [7200, "2 h"],
])("beside a mark %d s reads %s", (age, text) => {
  expect(words.shortAge(age)).toBe(text);
});

test("a responder is called by callsign, else by the node's own name", () => {
  expect(words.nameOf(aNode({ callsign: "E7-2" }))).toBe("E7-2");
  expect(words.nameOf(aNode({ callsign: null }))).toBe("ff1");
});

test("levels are called by their spoken names, and unknown ones say so", () => {
  expect(words.levelWords(0, STOREYS)).toBe("Level G");
  expect(words.levelWords(7, STOREYS)).toBe("Level 7");
  expect(words.levelWords(0, [{ level: 0, name: "Mezzanine", up_m: 0 }])).toBe("Mezzanine");
  expect(words.levelWords(null, STOREYS)).toBe("storey not known");
});

test("a probability never claims to be certain by rounding", () => {
  expect([1, 0.999, 0.93, 0.001, 0].map(words.percent)).toEqual(["100 %", "> 99 %", "93 %", "< 1 %", "0 %"]);
});

test.each([
  [0, "090°"],
  [Math.PI / 2, "000°"],
  [Math.PI, "270°"],
  [-Math.PI / 2, "180°"],
  [Math.PI / 2 + 0.001, "000°"],
])("a heading of %d rad from east is a compass bearing of %s", (heading, text) => {
  expect(words.compassBearing(heading)).toBe(text);
});

const told = (status: Status, age_s: number | null = null) => ({ status, age_s, oldAfter_s: 60 });

test("air and battery that were not reported are not made up", () => {
  const now = told("live");
  expect([words.airWords(null, now), words.batteryWords(null, now)]).toEqual([
    "not reported",
    "not reported",
  ]);
  expect([words.airWords(0, now), words.batteryWords(0, now)]).toEqual(["0 bar", "0 %"]);
  expect([words.airWords(182.4, now), words.batteryWords(0.8, now)]).toEqual(["182 bar", "80 %"]);
});

test("what somebody reported who is not heard any more is said to be of then", () => {
  expect(words.airWords(290, told("live"))).toBe("290 bar");
  const gone = [words.airWords(290, told("stale")), words.airWords(290, told("lost"))];
  expect(gone).toEqual(["was 290 bar", "was 290 bar"]);
  expect(words.airWords(null, told("lost"))).toBe("not reported");
});

test("who walks on while his air has not been told for minutes is not said to have that much", () => {
  expect(words.airWords(290, told("live", 60))).toBe("290 bar");
  expect(words.airWords(290, told("live", 240))).toBe("was 290 bar, 4 min ago");
  expect(words.batteryWords(0.8, told("live", 240))).toBe("was 80 %, 4 min ago");
  expect(words.airWords(290, told("lost", 240))).toBe("was 290 bar, 4 min ago");
});

test("no place is told by digits that mean nothing", () => {
  expect([12.44, 9999, 2.2e9].map(words.spread)).toEqual(["12.4 m", "9999 m", "over 10 km"]);
});

test("an age that only a wrong clock explains stays short", () => {
  expect([359_999, 5 * 86_400, 1.8e9].map(words.ageWords)).toEqual(["99 h 59 min", "5 days", "> 999 days"]);
  expect([359_999, 5 * 86_400, 1.8e9].map(words.shortAge)).toEqual(["99 h", "5 d", "> 999 d"]);
});

test("lengths carry their unit and no more digits than matter", () => {
  expect([0.84, 12.44, 130.4, -250.2].map(words.metres)).toEqual(["0.8 m", "12.4 m", "130 m", "-250 m"]);
});

test("to the west and south a distance has no sign of its own", () => {
  expect(words.sideways(-4.04, "E", "W")).toBe("4.0\u00a0m\u00a0W");
  expect(words.sideways(12, "N", "S")).toBe("12.0\u00a0m\u00a0N");
});

test("a long name gives way before its end, which tells it from others of its vehicle", () => {
  const names = ["Florian Frankfurt 1/46-1 Angriffstrupp", "Florian Frankfurt 1/46-1 Wassertrupp"];
  const parts = names.map(words.nameInParts);
  expect(parts.map((both) => both?.join(""))).toEqual(names);
  expect(parts.map((both) => both?.[1])).toEqual(["riffstrupp", "assertrupp"]);
  expect(["E7-1", "الإطفائي محمد عبد الرحمن"].map(words.nameInParts)).toEqual([null, null]);
});
