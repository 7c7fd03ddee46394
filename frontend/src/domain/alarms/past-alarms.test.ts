import { expect, test } from "vitest";
import stories from "../../../../tests/backend/tracking/alarm_stories.json";
import { anAlarm, NOON } from "../samples";
import type { LoggedAlarm } from "../time/logged";
import type { FrameAlarm } from "../types";
import { raisedOf } from "./past-alarms";

const said = (state: FrameAlarm["state"], after_s: number, seq: number): LoggedAlarm => ({
  ...anAlarm({ state, t: NOON + after_s }),
  seq,
});

const times = (...all: LoggedAlarm[]) => raisedOf(all).map(({ t }) => t - NOON);

test.each(stories)("the server's rule: $what", ({ said: story, raised }) => {
  const heard = story.map(([state, after_s, text], index) => ({
    ...said(state as FrameAlarm["state"], Number(after_s), index),
    text: text as string | null,
  }));
  expect(times(...heard)).toEqual(raised);
});

test("an order to evacuate that was lifted is over: its words are new again", () => {
  const order = (state: FrameAlarm["state"], after_s: number, text: string | null = null) => ({
    ...said(state, after_s, after_s),
    alarm: "evacuate" as const,
    text,
  });
  const lifted = [order("raised", 0, "all out"), order("cleared", 5)];
  const again = [order("raised", 9), order("acknowledged", 10), order("raised", 11, "all out")];
  expect(times(...lifted, ...again)).toEqual([0, 9, 11]);
});

test("it does not matter which part of the log was read first", () => {
  expect(times(said("raised", 9, 3), said("cleared", 5, 2), said("raised", 0, 1))).toEqual([0, 9]);
});

test("a call of a unit whose clock was put back since its last one is a new alarm, one that comes twice is not", () => {
  const over = [said("raised", 1000, 1), said("acknowledged", 1010, 2), said("cleared", 1020, 3)];
  expect(times(...over, said("raised", 5, 4))).toEqual([5, 1000]);
  const again = [said("raised", 5, 4), said("acknowledged", 1100, 5), said("cleared", 1110, 6)];
  expect(times(...over, ...again, said("raised", 1000, 7), said("raised", 5, 8))).toEqual([5, 1000]);
  expect(times(said("raised", 1000, 1), said("raised", 5, 2))).toEqual([1000]);
});
