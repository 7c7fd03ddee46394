import { describe, expect, test } from "vitest";
import { anAlarm, NOON } from "../samples";
import { alarmByNode, alarmKey, answered, inOrder, type StandingAlarms, standingAlarms } from "./alarms";

const raised = anAlarm();
const acknowledged = anAlarm({ state: "acknowledged" });
const cleared = anAlarm({ state: "cleared" });
const only = (standing: StandingAlarms) => standing.get(alarmKey(raised));

describe("an alarm", () => {
  test("stands, unacknowledged, as long as the server lists it as raised", () => {
    expect(only(standingAlarms([raised]))).toMatchObject({ acknowledged: false, cleared: false });
  });

  test("stands on when it is acknowledged but not cleared", () => {
    expect(only(standingAlarms([acknowledged]))).toMatchObject({ acknowledged: true, cleared: false });
  });

  test("that its unit cleared before anybody acknowledged it stands on every screen", () => {
    expect(only(standingAlarms([cleared]))).toMatchObject({ acknowledged: false, cleared: true });
  });

  test("is over once the server lists it no longer", () => {
    expect(standingAlarms([]).size).toBe(0);
  });

  test("of one kind does not hide another kind of the same responder", () => {
    expect(standingAlarms([raised, anAlarm({ alarm: "pass" })]).size).toBe(2);
  });
});

describe("a person's word on an alarm", () => {
  test("acknowledges it, and it stands until it is cleared", () => {
    const heard = answered(standingAlarms([raised]), raised, "acknowledged");
    expect(only(heard)).toMatchObject({ acknowledged: true, cleared: false });
    expect(answered(heard, raised, "cleared").size).toBe(0);
  });

  test("ends one that its unit has cleared already", () => {
    expect(answered(standingAlarms([cleared]), cleared, "acknowledged").size).toBe(0);
  });

  test("on one that is over changes nothing", () => {
    expect(answered(standingAlarms([]), raised, "acknowledged").size).toBe(0);
  });
});

test("what nobody has acknowledged comes first, then the gravest, then the oldest", () => {
  const list = [
    anAlarm({ node: "done", state: "acknowledged" }),
    anAlarm({ node: "help", alarm: "help", t: NOON - 9 }),
    anAlarm({ node: "later", t: NOON + 5 }),
    anAlarm({ node: "first" }),
  ];
  expect(inOrder(standingAlarms(list)).map(({ alarm }) => alarm.node)).toEqual([
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
