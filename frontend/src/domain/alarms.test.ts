import { describe, expect, test } from "vitest";
import {
  alarmByNode,
  alarmKey,
  inOrder,
  type StandingAlarms,
  standingAlarms,
  statesToAcknowledge,
} from "./alarms";
import { anAlarm, NOON } from "./samples";
import type { FrameAlarm } from "./types";

const NONE: StandingAlarms = new Map();

/** What stands after the server's lists have come one after the other. */
function standingAfter(...lists: FrameAlarm[][]): StandingAlarms {
  return lists.reduce<StandingAlarms>((standing, list) => standingAlarms(standing, list), NONE);
}

const raised = anAlarm();
const acknowledged = anAlarm({ state: "acknowledged" });
const cleared = anAlarm({ state: "cleared" });
const only = (standing: StandingAlarms) => standing.get(alarmKey(raised));

describe("an alarm", () => {
  test("stands, unacknowledged, however often it is listed", () => {
    expect(only(standingAfter([raised], [raised], [raised]))).toMatchObject({
      acknowledged: false,
      cleared: false,
    });
  });

  test("stands on when it is acknowledged but not cleared", () => {
    expect(only(standingAfter([raised], [acknowledged]))).toMatchObject({
      acknowledged: true,
      cleared: false,
    });
  });

  test.each([[[cleared]], [[]]])("is over once acknowledged and then cleared or no longer listed", (last) => {
    expect(standingAfter([raised], [acknowledged], last).size).toBe(0);
  });

  test.each([[[cleared]], [[]]])("that its unit cleared before anybody acknowledged it stands on", (last) => {
    expect(only(standingAfter([raised], last))).toMatchObject({ acknowledged: false, cleared: true });
    expect(only(standingAfter([raised], last, []))).toMatchObject({ acknowledged: false, cleared: true });
  });

  test("raised again after it was acknowledged calls anew", () => {
    const again = anAlarm({ t: NOON + 60 });
    expect(only(standingAfter([raised], [acknowledged], [again]))).toMatchObject({
      acknowledged: false,
      alarm: again,
    });
  });

  test("cleared before this screen was opened is not shown", () => {
    expect(standingAfter([cleared]).size).toBe(0);
  });

  test("of one kind does not hide another kind of the same responder", () => {
    expect(standingAfter([raised, anAlarm({ alarm: "pass" })]).size).toBe(2);
  });
});

test("acknowledging an alarm that its unit has cleared closes it in the same act", () => {
  const byUnit = only(standingAfter([raised], [cleared]));
  const standing = only(standingAfter([raised]));
  expect(byUnit && statesToAcknowledge(byUnit)).toEqual(["acknowledged", "cleared"]);
  expect(standing && statesToAcknowledge(standing)).toEqual(["acknowledged"]);
});

test("what nobody has acknowledged comes first, then the gravest, then the oldest", () => {
  const list = [
    anAlarm({ node: "done", state: "acknowledged" }),
    anAlarm({ node: "help", alarm: "help", t: NOON - 9 }),
    anAlarm({ node: "later", t: NOON + 5 }),
    anAlarm({ node: "first" }),
  ];
  expect(inOrder(standingAfter(list)).map(({ alarm }) => alarm.node)).toEqual([
    "first",
    "later",
    "help",
    "done",
  ]);
});

test("a responder in two alarms shows the graver, one whose alarm is cleared shows none", () => {
  const byNode = alarmByNode([
    anAlarm({ alarm: "help" }),
    raised,
    anAlarm({ node: "ff2", state: "cleared" }),
  ]);
  expect([...byNode].map(([node, { alarm }]) => [node, alarm])).toEqual([["ff1", "mayday"]]);
});
