import { expect, test } from "vitest";
import { DEFAULT_LIMITS } from "../fixes/staleness";
import { aNode, anAlarm, NOON, pictureWith, STOREYS } from "../samples";
import {
  board,
  boardCounts,
  neighbourOnBoard,
  nextOfStatus,
  radioCounts,
  withoutFix,
} from "./accountability";

const picture = pictureWith(
  aNode({ node: "u1", role: "uav", callsign: "UAV-1", crew: null }),
  aNode({ node: "ff9", callsign: "Runner", crew: null }),
  aNode({ node: "ff10", callsign: "E7-10" }),
  aNode({ node: "ff2", callsign: "E7-2", level: 1, level_p: 0.7 }),
  aNode({ node: "ff3", callsign: "E5-1", crew: "E5", t: NOON - 30 }),
  aNode({ node: "ff4", callsign: "E5-2", crew: "E5", t: NOON - 90 }),
  aNode({ node: "ff5", callsign: "E5-3", crew: "E5", status: "retired" }),
  aNode({ node: "b1", role: "breadcrumb", callsign: null, crew: null }),
  aNode({ node: "b2", role: "breadcrumb", callsign: null, crew: null, t: NOON - 100, moved: true }),
  aNode({ node: "base", role: "base", callsign: null, crew: null, t: NOON - 9999 }),
);
const alarms = new Map([["ff2", anAlarm({ node: "ff2" })]]);
const crews = board(picture, NOON, STOREYS, DEFAULT_LIMITS, alarms);

test("the board goes crew by crew, then those without one, then aircraft", () => {
  expect(crews.map(({ crew, rows }) => [crew, ...rows.map(({ name }) => name)])).toEqual([
    ["E5", "E5-1", "E5-2", "E5-3"],
    ["E7", "E7-2", "E7-10"],
    ["No crew", "Runner"],
    ["UAV", "UAV-1"],
  ]);
});

test("a row says alarm, status, and the storey with its probability where it is not sure", () => {
  const row = crews[1]?.rows[0];
  expect(row).toMatchObject({
    alarm: "MAYDAY",
    statusWord: "Live",
    level: "Level 1, 70 %",
    levelUnsure: true,
  });
  expect(crews[1]?.rows[1]).toMatchObject({ alarm: null, level: "Level G", levelUnsure: false });
});

test("air that was told long ago is of then, though its bearer is live, and told by whom nobody knows when, of now", () => {
  const airOf = (air_t?: number) =>
    board(
      pictureWith(aNode({ air_bar: 180, ...(air_t !== undefined && { air_t }) })),
      NOON,
      STOREYS,
      DEFAULT_LIMITS,
      new Map(),
    )[0]?.rows[0];
  expect(airOf(NOON - 30)).toMatchObject({ air: "180 bar", airOld: false });
  expect(airOf(NOON - 300)).toMatchObject({ status: "live", air: "was 180 bar, 5 min ago", airOld: true });
  expect(airOf()).toMatchObject({ air: "180 bar", airOld: false });
});

test("beside the pressure it is said that it is time to turn back, and that it is low; of who has left nothing", () => {
  const rowOf = (over: Parameters<typeof aNode>[0]) =>
    board(pictureWith(aNode(over)), NOON, STOREYS, DEFAULT_LIMITS, new Map())[0]?.rows[0];
  expect(rowOf({ air_bar: 250 })).toMatchObject({ airState: null, airLow: false });
  expect(rowOf({ air_bar: 170, air_state: "turn_back" })).toMatchObject({
    airState: "turn back",
    airLow: false,
  });
  expect(rowOf({ air_bar: 50, air_state: "low" })).toMatchObject({ airState: "LOW AIR", airLow: true });
  expect(rowOf({ air_state: "low", status: "retired" })).toMatchObject({ airState: null, airLow: false });
});

test("of the past it is said who was live", () => {
  const rows = board(picture, NOON, STOREYS, DEFAULT_LIMITS, alarms, true)[0]?.rows;
  expect(rows?.map(({ statusWord }) => statusWord)).toEqual(["Stale", "Lost", "Not tracked"]);
  const [row] = board(pictureWith(aNode()), NOON, STOREYS, DEFAULT_LIMITS, alarms, true)[0]?.rows ?? [];
  expect(row).toMatchObject({ status: "live", statusWord: "Was live" });
});

test("rows age by themselves, without another word from the server", () => {
  const later = board(picture, NOON + 70, STOREYS, DEFAULT_LIMITS, alarms);
  expect(later[1]?.rows[1]).toMatchObject({ status: "lost", age_s: 70 });
  expect(later[1]?.rows[1]?.error_m).toBeGreaterThan(50);
});

test("responders are counted by status; aircraft are none, and who has left stands apart", () => {
  expect(boardCounts(crews)).toEqual({ responders: 5, live: 3, stale: 1, lost: 1, left: 1 });
});

test("radios that fell silent or were moved are named; the base does not fall silent by age", () => {
  expect(radioCounts(picture, NOON, DEFAULT_LIMITS)).toEqual({
    breadcrumbs: 2,
    others: 1,
    silent: ["b2"],
    moved: ["b2"],
  });
});

test("next and previous go round the board in its order", () => {
  expect(neighbourOnBoard(crews, null, 1)).toBe("ff3");
  expect(neighbourOnBoard(crews, null, -1)).toBe("u1");
  expect(neighbourOnBoard(crews, "ff5", 1)).toBe("ff2");
  expect(neighbourOnBoard(crews, "u1", 1)).toBe("ff3");
  expect(neighbourOnBoard([], "ff1", 1)).toBeNull();
});

test("of those who are lost the next one on the board is found, going round; aircraft are none of them", () => {
  const later = board(picture, NOON + 70, STOREYS, DEFAULT_LIMITS, alarms);
  const lost = ["ff3", "ff4", "ff2", "ff10", "ff9"];
  expect(nextOfStatus(later, null, "lost")).toBe("ff3");
  for (const [at, node] of lost.entries()) {
    expect(nextOfStatus(later, node, "lost")).toBe(lost[(at + 1) % lost.length]);
  }
  expect(nextOfStatus(later, "u1", "lost")).toBe("ff3");
  expect(nextOfStatus(later, "ff3", "stale")).toBeNull();
});

test("whoever has no position yet is named, as the map cannot show him; who has left is not", () => {
  const nowhere = { position_m: null, covariance_m2: null };
  const some = pictureWith(
    aNode({ node: "ff1", callsign: "E7-1" }),
    aNode({ node: "ff2", callsign: "E7-2", ...nowhere }),
    aNode({ node: "ff3", callsign: "E7-3", status: "retired", ...nowhere }),
    aNode({ node: "u1", role: "uav", ...nowhere }),
  );
  const crews = board(some, NOON, STOREYS, DEFAULT_LIMITS, new Map());
  expect(withoutFix(crews, new Map())).toEqual(["E7-2"]);
  expect(withoutFix(crews, new Map([["ff2", "clock 10 min ahead"]]))).toEqual([]);
});

test("crews stand in the order of their numbers", () => {
  const engines = ["Engine 10", "Engine 2", "Engine 1"].map((crew) => aNode({ node: crew, crew }));
  const rows = board(pictureWith(...engines), NOON, STOREYS, DEFAULT_LIMITS, new Map());
  expect(rows.map(({ crew }) => crew)).toEqual(["Engine 1", "Engine 2", "Engine 10"]);
});
