import { describe, expect, test } from "vitest";
import { anAlarm, anIncident, NOON } from "../samples";
import type { Track } from "../types";
import {
  eventsAt,
  extentOf,
  HANDLE_STEP_S,
  handleFrom,
  type Mark,
  neighbourMark,
  nextSpeed,
  withAlarmMarks,
  withDropMarks,
  within,
  withSetMarks,
} from "./timeline";

const UNSEEN = Number.POSITIVE_INFINITY;

const track = (node: string, t: number): Track => ({ node, points: [[t, 0, 0, 0, 1, 0, 0, 1, 0, 1]] });

test("speeds go from a half to 32 and stop there", () => {
  expect([
    nextSpeed(1, 1),
    nextSpeed(1, -1),
    nextSpeed(32, 1),
    nextSpeed(0.5, -1),
    nextSpeed(99, -1),
  ]).toEqual([2, 0.5, 32, 0.5, 16]);
});

describe("the bar", () => {
  test.each([1, 1.3, 4.74, 7200.01])(
    "is whole steps long, so that the handle reaches its end after %d s",
    (long) => {
      const from = handleFrom({ from: NOON, to: NOON + long });
      expect(((NOON + long - from) / HANDLE_STEP_S) % 1).toBeCloseTo(0);
      expect(NOON - from).toBeGreaterThanOrEqual(0);
      expect(NOON - from).toBeLessThan(HANDLE_STEP_S);
    },
  );

  test("begins no later than what this screen has seen, though no row of it is stored yet", () => {
    expect(extentOf(anIncident({ first_t: null }), [], NOON + 2, NOON + 60).from).toBe(NOON + 2);
  });

  test("of a live incident does not begin decades before it because the clock of one unit was never set", () => {
    const one = [track("unset", 5), track("ff1", NOON + 7)];
    const live = anIncident({ first_t: 5, earliest_t: NOON - 100 });
    expect(extentOf(live, one, 5, NOON + 60).from).toBe(NOON + 7);
    expect(extentOf(live, [track("held back", NOON - 100)], 5, NOON + 60).from).toBe(NOON - 100);
    expect(extentOf(live, [], 5, NOON + 60).from).toBe(NOON);
    expect(extentOf(anIncident({ first_t: 5, clock: "recorded" }), [], UNSEEN, NOON + 60).from).toBe(5);
  });

  test("begins at the first second that can be shown, or the first point of a track", () => {
    expect(extentOf(anIncident({ first_t: NOON + 5 }), [], UNSEEN, NOON + 60).from).toBe(NOON + 5);
    expect(
      extentOf(anIncident(), [track("ff1", NOON + 9), track("b1", NOON + 7)], UNSEEN, NOON + 60).from,
    ).toBe(NOON + 7);
  });

  test("of a live incident without any point begins when it was created", () => {
    expect(extentOf(anIncident(), [], UNSEEN, NOON + 60)).toEqual({ from: NOON, to: NOON + 60 });
  });

  test("is never empty", () => {
    expect(extentOf(null, [], UNSEEN, NOON)).toEqual({ from: NOON - 1, to: NOON });
  });

  test("holds every time that is asked for", () => {
    const extent = { from: 10, to: 20 };
    expect([5, 15, 25].map((t) => within(extent, t))).toEqual([10, 15, 20]);
  });
});

describe("drop marks", () => {
  const lying = withDropMarks([], [{ node: "b1", t: NOON }], (node) => node.toUpperCase());

  test("say which breadcrumb", () => {
    expect(lying).toEqual([{ t: NOON, kind: "drop", text: "B1 dropped" }]);
  });

  test("are set once, though the picture and the log tell of the same drop a little apart", () => {
    expect(withDropMarks(lying, [{ node: "b1", t: NOON + 1 }], () => "B1")).toBe(lying);
  });

  test("are set again for one that is dropped again, in order of time", () => {
    const both = withDropMarks(lying, [{ node: "b1", t: NOON - 60 }], () => "B1");
    expect(both.map(({ t }) => t - NOON)).toEqual([-60, 0]);
  });
});

describe("alarm marks", () => {
  const first = withAlarmMarks([], [anAlarm()], () => "E7-1");

  test("say which alarm and who", () => {
    expect(first).toEqual([{ t: NOON, kind: "alarm", text: "MAYDAY E7-1" }]);
  });

  test("are set once, and not for acknowledging", () => {
    const acknowledged = anAlarm({ state: "acknowledged" });
    expect(withAlarmMarks(first, [anAlarm(), acknowledged], () => "E7-1")).toBe(first);
  });

  test("stay in the order of time", () => {
    const both = withAlarmMarks(first, [anAlarm({ t: NOON - 60 })], () => "E7-1");
    expect(both.map(({ t }) => t)).toEqual([NOON - 60, NOON]);
  });
});

test("the next and the previous mark are the nearest ones on either side", () => {
  const marks: Mark[] = [10, 20, 30].map((t) => ({ t, kind: "drop", text: "" }));
  expect(neighbourMark(marks, 20, 1)?.t).toBe(30);
  expect(neighbourMark(marks, 20, -1)?.t).toBe(10);
  expect(neighbourMark(marks, 30, 1)).toBeNull();
});

test("what happened within a second of the moment that is shown is said, and nothing else", () => {
  const marks: Mark[] = [0, 0.9, 2].map((s) => ({ t: NOON + s, kind: "drop", text: `b${s} dropped` }));
  expect(eventsAt(marks, NOON).map(({ text }) => text)).toEqual(["b0 dropped", "b0.9 dropped"]);
  expect(eventsAt(marks, NOON + 5)).toEqual([]);
});

test("what was set is marked once, among the alarms", () => {
  const set: Mark[] = [{ t: NOON + 5, kind: "set", text: "Set: storeys" }];
  const alarms = withAlarmMarks([], [anAlarm({ t: NOON }), anAlarm({ t: NOON + 60 })], String);
  const marks = withSetMarks(alarms, set);
  expect(marks.map(({ kind }) => kind)).toEqual(["alarm", "set", "alarm"]);
  expect(withSetMarks(marks, set)).toBe(marks);
});
