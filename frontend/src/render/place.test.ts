import { expect, test } from "vitest";
import { aNode, anAlarm, NOON, pictureWith } from "../domain/samples";
import { movers } from "./place";
import { aScene } from "./samples";

test("who is not heard lies over who is, who calls over both, and the chosen one over all", () => {
  const crew = pictureWith(
    aNode({ node: "calls" }),
    aNode({ node: "chosen" }),
    aNode({ node: "lost", t: NOON - 90 }),
    aNode({ node: "stale", t: NOON - 30 }),
    aNode({ node: "live" }),
  );
  const alarms = new Map([["calls", anAlarm({ node: "calls" })]]);
  const drawn = movers(aScene({ picture: crew, alarms, selected: "chosen" }));
  expect(drawn.map(({ node }) => node.node)).toEqual(["live", "stale", "lost", "calls", "chosen"]);
});

test("who is not heard on another storey than the one shown lies under who is on it", () => {
  const levels = [0, 1].map((level) => ({ level, name: String(level), up_m: 3 * level }));
  const crew = pictureWith(
    aNode({ node: "above", level: 1, t: NOON - 90 }),
    aNode({ node: "here", level: 0 }),
  );
  const drawn = movers(aScene({ picture: crew, levels, level: 0 }));
  expect(drawn.map(({ node }) => node.node)).toEqual(["above", "here"]);
});
