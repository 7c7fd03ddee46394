import { describe, expect, test } from "vitest";
import { anAlarm, NOON } from "../samples";
import { alarmWord } from "../words";
import {
  alarmByNode,
  alarmKey,
  answerable,
  answered,
  callerKey,
  callers,
  inOrder,
  linesEach,
  type StandingAlarms,
  saidBy,
  standingAlarms,
} from "./alarms";

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

describe("who calls in more than one way", () => {
  const still = anAlarm({ alarm: "pass", t: NOON - 30, text: "no movement for 30 s" });
  const everyone = (...list: Parameters<typeof standingAlarms>[0]) => callers(inOrder(standingAlarms(list)));
  const kinds = (list: ReturnType<typeof answerable>) => list.map(({ alarm }) => alarm.alarm);

  test("is one caller, by the gravest of the calls, where the most urgent one stands", () => {
    const found = everyone(still, anAlarm(), anAlarm({ node: "ff2", t: NOON + 3 }));
    expect(found.map(({ node, calls }) => [node, ...kinds(calls)])).toEqual([
      ["ff1", "mayday", "pass"],
      ["ff2", "mayday"],
    ]);
  });

  test("is not answered, and comes first again, once there is a call that nobody has answered", () => {
    const found = everyone(still, acknowledged, anAlarm({ node: "ff2", state: "acknowledged" }));
    expect(found.map(({ node, acknowledged }) => [node, acknowledged])).toEqual([
      ["ff1", false],
      ["ff2", true],
    ]);
    expect(kinds(found[0]?.calls ?? [])).toEqual(["mayday", "pass"]);
  });

  test("is answered for what nobody has answered yet, then for all", () => {
    const [half] = everyone(still, acknowledged);
    const [whole] = everyone({ ...still, state: "acknowledged" }, acknowledged);
    expect(half && kinds(answerable(half))).toEqual(["pass"]);
    expect(whole && kinds(answerable(whole))).toEqual(["mayday", "pass"]);
  });

  test("is another one under the finger once a call or an answer comes", () => {
    const keys = [[anAlarm()], [anAlarm(), still], [acknowledged, still]].map((list) =>
      everyone(...list)
        .map(callerKey)
        .join(),
    );
    expect(new Set(keys).size).toBe(3);
  });

  test("says all of it, and by which call after the first", () => {
    const said = (...list: Parameters<typeof standingAlarms>[0]) =>
      everyone(...list).map((caller) => saidBy(caller, alarmWord));
    expect(said(still, anAlarm({ text: "trapped" }))).toEqual(["trapped · PASS: no movement for 30 s"]);
    expect(said(still, anAlarm({ text: null }))).toEqual(["PASS: no movement for 30 s"]);
    expect(said(anAlarm({ text: null }))).toEqual([""]);
  });
});

test("the more call, the fewer lines each says, and never none", () => {
  expect([2, 3, 8].map((count) => linesEach(count, 269, false))).toEqual([2, 1, 1]);
  expect(linesEach(2, 358, true)).toBe(3);
  expect(linesEach(2, 358, false, 2)).toBe(1);
});
