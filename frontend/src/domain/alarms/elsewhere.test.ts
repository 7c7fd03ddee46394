import { describe, expect, test } from "vitest";
import { A_BREAK, A_DELAY, aFrame, aNode, anAlarm, anIncident, NOON } from "../samples";
import type { FrameAlarm, Incident } from "../types";
import {
  blindElsewhere,
  callAgeS,
  callsElsewhere,
  glimpseOf,
  mustSound,
  toLookInto,
  unansweredInWords,
} from "./elsewhere";

const HERE = anIncident({ id: "here", last_seq: 9 });
const MILL = anIncident({ id: "mill", name: "Mill fire", last_seq: 4 });
const DOCK = anIncident({ id: "dock", name: "Dock fire", last_seq: 7 });
const E9 = aNode({ node: "ff9", callsign: "E9-1" });
const mayday = anAlarm({ node: "ff9" });

const seen = (incident: Incident, ...alarms: FrameAlarm[]) =>
  [incident.id, glimpseOf(incident, aFrame([E9], { seq: incident.last_seq, alarms }), 1000)] as const;

const calls = (...glimpses: (readonly [string, ReturnType<typeof glimpseOf>])[]) =>
  callsElsewhere([HERE, MILL, DOCK], "here", new Map(glimpses));

describe("it is looked into", () => {
  test("every other incident in whose log there is something", () => {
    const quiet = anIncident({ id: "quiet", last_seq: 0 });
    expect(toLookInto([HERE, MILL, quiet], "here", new Map())).toEqual([MILL]);
  });

  test("one that was seen, again once its log has grown", () => {
    const glimpses = new Map([seen(MILL)]);
    expect(toLookInto([MILL], "here", glimpses)).toEqual([]);
    const grown = { ...MILL, last_seq: 5 };
    expect(toLookInto([grown], "here", glimpses)).toEqual([grown]);
  });
});

describe("a call for help in another incident", () => {
  test("says who calls, where and since when", () => {
    const [call] = calls(seen(MILL, mayday));
    expect([call?.who, call?.incident.name, call?.more]).toEqual(["E9-1", "Mill fire", 0]);
    expect(call && callAgeS(call, 5000)).toBe(4);
  });

  test("by a node that has no name is the node's", () => {
    expect(calls(seen(MILL, anAlarm({ node: "ff8" })))[0]?.who).toBe("ff8");
  });

  test("that nobody has answered comes before one that is acknowledged, however grave", () => {
    const list = calls(
      seen(MILL, anAlarm({ node: "ff9", state: "acknowledged" })),
      seen(DOCK, anAlarm({ node: "ff9", alarm: "help" })),
    );
    expect(list.map(({ incident }) => incident.id)).toEqual(["dock", "mill"]);
  });

  test("of one person in two ways is one person's", () => {
    expect(calls(seen(MILL, anAlarm({ node: "ff9", alarm: "pass" }), mayday))[0]?.more).toBe(0);
  });

  test("is one entry with the others who call there, the gravest named", () => {
    const [call, ...others] = calls(seen(MILL, anAlarm({ node: "ff8", alarm: "pass" }), mayday));
    expect([call?.call.alarm.alarm, call?.more, others.length]).toEqual(["mayday", 1, 0]);
  });

  test("is not told where the incident is the one that is shown, or is closed", () => {
    expect(callsElsewhere([HERE, MILL], "mill", new Map([seen(MILL, mayday)]))).toEqual([]);
    expect(callsElsewhere([HERE], "here", new Map([seen(MILL, mayday)]))).toEqual([]);
  });

  test("is none where it is an order to its crews", () => {
    expect(calls(seen(MILL, anAlarm({ node: "ff9", alarm: "evacuate" })))).toEqual([]);
  });
});

test.each([A_BREAK, A_DELAY])(
  "where the picture is not of now, no call would be seen: that is told",
  (why) => {
    const still = glimpseOf(MILL, aFrame([E9], { notices: [why] }), 1000);
    const glimpses = new Map([["mill", still] as const, seen(DOCK)]);
    expect(blindElsewhere([HERE, MILL, DOCK], "here", glimpses)).toEqual(["Mill fire"]);
    expect(blindElsewhere([HERE, MILL, DOCK], "mill", glimpses)).toEqual([]);
  },
);

test("it is said aloud as long as nobody has answered, in words that do not count the seconds", () => {
  expect(unansweredInWords(calls(seen(MILL, mayday)))).toBe("MAYDAY E9-1 in Mill fire.");
  expect(unansweredInWords(calls(seen(MILL, anAlarm({ node: "ff9", state: "acknowledged" }))))).toBe("");
});

test("it sounds until a person has answered, but not out of an import or an exercise", () => {
  expect(mustSound(calls(seen(MILL, mayday)))).toBe(true);
  expect(mustSound(calls(seen(MILL, anAlarm({ node: "ff9", state: "cleared" }))))).toBe(true);
  expect(mustSound(calls(seen(MILL, anAlarm({ node: "ff9", state: "acknowledged" }))))).toBe(false);
  const recorded: Incident = { ...MILL, clock: "recorded" };
  const list = callsElsewhere([recorded], "here", new Map([seen(recorded, mayday)]));
  expect([mustSound(list), callAgeS(list[0] ?? expect.fail(), 9_000_000), NOON - mayday.t]).toEqual([
    false,
    0,
    0,
  ]);
});
