import { expect, test } from "vitest";
import { aNode, NOON } from "../samples";
import { dropsOf, loggedIn, newBreadcrumbs, newestIn } from "./logged";

const line = (readings: object[], rejected: object[] = []) =>
  JSON.stringify({ seq: 7, received: NOON, gateway: "g", batch: "b", rejected, readings });

const crumb = (t: number, node = "b1") => ({ kind: "node", t, node, role: "breadcrumb" });

test("the alarms of a line are found among its other readings, those set aside are not", () => {
  const call = { kind: "alarm", t: NOON, node: "ff1", alarm: "mayday", state: "raised" };
  const readings = [
    { kind: "rssi", t: NOON, a: "alarm", b: "ff1", dbm: -50 },
    call,
    { ...call, t: NOON + 1 },
  ];
  const { alarms } = loggedIn(line(readings, [{ index: 2, code: "old", message: "too old" }]), "recorded");
  expect(alarms.map(({ seq, node, t }) => [seq, node, t])).toEqual([[7, "ff1", NOON]]);
});

test("a line of anything else says nothing", () => {
  const quiet = line([
    { kind: "status", t: NOON, node: "ff1" },
    { kind: "node", t: NOON, node: "ff1", role: "responder" },
  ]);
  expect(loggedIn(quiet, "recorded")).toEqual({ alarms: [], drops: [] });
});

test("a breadcrumb was dropped when it is said to have been, not when it was introduced", () => {
  const { drops } = loggedIn(
    line([crumb(NOON - 90), { kind: "drop", t: NOON, node: "b1", by: "ff1" }]),
    "recorded",
  );
  expect(dropsOf(drops)).toEqual([{ node: "b1", t: NOON }]);
});

test("one that is picked up and dropped again was dropped twice", () => {
  const drops = [NOON, NOON + 60].map((t) => ({ node: "b1", t, dropped: true }));
  expect(dropsOf(drops).map(({ t }) => t)).toEqual([NOON, NOON + 60]);
});

test("of one that nobody is said to have dropped the first introduction counts, in whatever order it was read", () => {
  const { drops } = loggedIn(line([crumb(NOON + 30), crumb(NOON), crumb(NOON + 5, "b2")]), "recorded");
  expect(dropsOf(drops)).toEqual([
    { node: "b1", t: NOON },
    { node: "b2", t: NOON + 5 },
  ]);
});

test("only breadcrumbs that were not in the picture are new", () => {
  const lying = [
    aNode({ node: "b1", role: "breadcrumb" }),
    aNode({ node: "b2", role: "breadcrumb" }),
    aNode(),
  ];
  expect(newBreadcrumbs(lying, new Set(["b1"]))).toEqual([{ node: "b2", t: NOON }]);
});

test("an alarm from a clock that is ahead is of when it came, and no other is", () => {
  const call = { kind: "alarm", t: NOON + 3600, node: "ff1", alarm: "mayday", state: "raised" };
  const timesOf = (alarm: object, clock: "live" | "recorded") =>
    loggedIn(line([alarm]), clock).alarms.map(({ t }) => t - NOON);
  expect([timesOf(call, "live"), timesOf({ ...call, t: NOON - 5 }, "live")]).toEqual([[0], [-5]]);
  expect(timesOf(call, "recorded")).toEqual([3600]);
});

test("the newest epoch of a line is that of its readings, without those set aside", () => {
  const readings = [{ t: 5 }, { t: 900 }, { t: 7 }];
  expect(newestIn(JSON.stringify({ readings, rejected: [{ index: 1 }] }))).toBe(7);
  expect(newestIn(JSON.stringify({ readings: [] }))).toBe(Number.NEGATIVE_INFINITY);
});
