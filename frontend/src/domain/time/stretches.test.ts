import { describe, expect, test } from "vitest";
import { anIncident, NOON } from "../samples";
import type { Stretch } from "../types";
import { setMarks, toldAt } from "./stretches";

const GROUND = [{ level: 0, name: "G", up_m: 0 }];
const opened: Stretch = {
  after_seq: 0,
  since: NOON,
  origin: null,
  levels: [],
  settings: { tracker: "kirchhoff", lag_s: 60 },
};
const storeys: Stretch = { ...opened, after_seq: 7, since: NOON + 60, levels: GROUND };
const tracker: Stretch = {
  ...storeys,
  after_seq: 9,
  since: NOON + 90,
  settings: { tracker: "paper-a", lag_s: 5 },
};
const stretches = [opened, storeys, tracker];
const now = { levels: tracker.levels, settings: tracker.settings, stretches };

describe("what is shown of the past", () => {
  const live = anIncident(now);
  test.each([
    [NOON - 1, opened],
    [NOON + 59.9, opened],
    [NOON + 60, storeys],
    [NOON + 90, tracker],
  ])("at %d has the storeys and settings of then", (t, { levels, settings }) => {
    expect(toldAt(live, t, 99)).toEqual({ ...live, levels, settings });
  });

  test.each([
    [0, opened],
    [7, opened],
    [8, storeys],
    [10, tracker],
  ])("where readings are the clock, with entry %d has those after which it came", (seq, told) => {
    expect(toldAt(anIncident({ ...now, clock: "recorded" }), NOON, seq).settings).toEqual(told.settings);
    expect(toldAt(anIncident({ ...now, clock: "recorded" }), NOON, seq).levels).toEqual(told.levels);
  });
});

test("the timeline says when something was set, and what", () => {
  expect(setMarks(anIncident({ ...now, clock: "live" }), new Map())).toEqual([
    { t: NOON + 60, kind: "set", text: "Set: storeys" },
    { t: NOON + 90, kind: "set", text: "Set: tracker paper-a, lag 5" },
  ]);
  expect(setMarks(anIncident({ stretches: [opened] }), new Map())).toEqual([]);
});

test("where readings are the clock, it was set at the newest epoch that had been told by then", () => {
  const recorded = anIncident({ ...now, clock: "recorded" });
  expect(setMarks(recorded, new Map([[7, 1003]]))).toEqual([{ t: 1003, kind: "set", text: "Set: storeys" }]);
  expect(setMarks(recorded, new Map())).toEqual([]);
});
