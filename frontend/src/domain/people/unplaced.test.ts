import { expect, test } from "vitest";
import { pictureOf } from "../picture";
import { aFrame, aNode, NOON } from "../samples";
import type { FrameMessage } from "../types";
import { nameInText } from "../words";
import { unplaced, unplacedInWords, whyUnplaced } from "./unplaced";

type Aside = FrameMessage["set_aside"][number];

const AHEAD = "clock 10 min ahead: set it";

function anAside(name: string, over: Partial<Aside> = {}): Aside {
  const said = { callsign: null, crew: null, gateway: "engine-7", code: "time_in_future", text: AHEAD };
  return { name, t: NOON - 4, ...said, ...over };
}

function late(node: string): FrameMessage["notices"][number] {
  return { code: "too_late", t: NOON - 900, text: "3 readings so far came late", node };
}

test("those whom one reason keeps from the map stand together, with when one of them was heard last", () => {
  const asides = [anAside("ff1", { callsign: "E7-1" }), anAside("ff2", { t: NOON - 2 })];
  const other = anAside("ff3", { gateway: "engine-9" });
  expect(unplaced(pictureOf(aFrame([], { set_aside: [...asides, other] })), NOON)).toEqual([
    { names: ["E7-1", "ff2"], why: AHEAD, gateway: "engine-7", heard_s: 2 },
    { names: ["ff3"], why: AHEAD, gateway: "engine-9", heard_s: 4 },
  ]);
});

test("who does not say a name is told of all the same", () => {
  const [found] = unplaced(pictureOf(aFrame([], { set_aside: [anAside("")] })), NOON);
  expect(found?.names).toEqual(["a unit without a name"]);
  expect(found?.names.map(nameInText)).toEqual(found?.names);
});

test("who is nowhere because the readings come too late is told so, whether the board knows of him or not", () => {
  const nowhere = aNode({ node: "ff1", callsign: "E7-1", position_m: null, covariance_m2: null });
  const placed = aNode({ node: "ff2", callsign: "E7-2" });
  const picture = pictureOf(aFrame([nowhere, placed], { notices: ["ff1", "ff2", "ff9"].map(late) }));
  expect(unplaced(picture, NOON)).toEqual([
    { names: ["E7-1", "ff9"], why: "3 readings so far came late", gateway: null, heard_s: null },
  ]);
  expect([...whyUnplaced(picture).keys()]).toEqual(["ff1", "ff9"]);
});

test("whose fixes are latitudes is told of where the incident has no origin, a UAV as well as who has no line yet", () => {
  const text = "the incident has no origin in WGS84";
  const notices = ["uav-1", "ff2", "ff3"].map((node) => ({ code: "no_origin", t: NOON, text, node }));
  const uav = aNode({ node: "uav-1", role: "uav", callsign: "UAV 1", position_m: null, covariance_m2: null });
  const picture = pictureOf(aFrame([uav, aNode({ node: "ff3" })], { notices }));
  expect(unplaced(picture, NOON)).toEqual([
    { names: ["UAV 1", "ff2"], why: text, gateway: null, heard_s: null },
  ]);
});

test("it is said aloud with the reason, and without ages, which count up", () => {
  const picture = pictureOf(aFrame([], { set_aside: [anAside("ff1")] }));
  expect(unplacedInWords(unplaced(picture, NOON))).toBe(`Heard, not followed: ff1: ${AHEAD}.`);
  expect(unplacedInWords(unplaced(picture, NOON + 9))).toBe(unplacedInWords(unplaced(picture, NOON)));
  expect(unplaced(null, NOON)).toEqual([]);
});
