import { expect, test } from "vitest";
import { alarmsInLine, type LoggedAlarm, raisedOf } from "./past-alarms";
import { anAlarm, NOON } from "./samples";
import type { FrameAlarm } from "./types";

const line = (readings: object[], rejected: object[] = []) =>
  JSON.stringify({ seq: 7, received: NOON, gateway: "g", batch: "b", rejected, readings });

const said = (state: FrameAlarm["state"], after_s: number, seq: number): LoggedAlarm => ({
  ...anAlarm({ state, t: NOON + after_s }),
  seq,
});

const times = (...all: LoggedAlarm[]) => raisedOf(all).map(({ t }) => t - NOON);

test("the alarms of a line are found among its other readings, those set aside are not", () => {
  const call = { kind: "alarm", t: NOON, node: "ff1", alarm: "mayday", state: "raised" };
  const readings = [
    { kind: "rssi", t: NOON, a: "alarm", b: "ff1", dbm: -50 },
    call,
    { ...call, t: NOON + 1 },
  ];
  const found = alarmsInLine(line(readings, [{ index: 2, code: "old", message: "too old" }]));
  expect(found.map(({ seq, node, t }) => [seq, node, t])).toEqual([[7, "ff1", NOON]]);
});

test("a line without an alarm has none", () => {
  expect(alarmsInLine(line([{ kind: "status", t: NOON, node: "ff1" }]))).toEqual([]);
});

test("an alarm that its unit repeats was raised once, until it is cleared", () => {
  expect(times(said("raised", 0, 1), said("raised", 5, 2), said("raised", 90, 3))).toEqual([0]);
  expect(times(said("raised", 0, 1), said("cleared", 5, 2), said("raised", 9, 3))).toEqual([0, 9]);
});

test("an acknowledged alarm that sounds on is the same one, one that comes after a while is another", () => {
  const heard = [said("raised", 0, 1), said("acknowledged", 4, 2), said("raised", 20, 3)];
  expect(times(...heard)).toEqual([0]);
  expect(times(...heard, said("raised", 80, 4))).toEqual([0, 80]);
});

test("it does not matter which part of the log was read first", () => {
  expect(times(said("raised", 9, 3), said("cleared", 5, 2), said("raised", 0, 1))).toEqual([0, 9]);
});
