import { expect, test } from "vitest";
import { glimpseOf } from "../alarms/elsewhere";
import { pictureOf, withDelta } from "../picture";
import { aDelta, aFrame, aNode, anAlarm, anIncident } from "../samples";
import { nameOf } from "../words";

const alike = [aNode({ node: "imu7", callsign: "E7-1" }), aNode({ node: "imu9", callsign: "E7-1" })];
const names = (picture: ReturnType<typeof pictureOf>) =>
  Object.fromEntries([...picture.nodes].map(([node, { state }]) => [node, nameOf(state)]));

test("two who are called alike are told apart by their units, and nobody else is named otherwise", () => {
  const picture = pictureOf(aFrame([...alike, aNode({ node: "ff3", callsign: "E7-3" })]));
  expect(names(picture)).toEqual({ imu7: "E7-1 (imu7)", imu9: "E7-1 (imu9)", ff3: "E7-3" });
});

test("who is called as another's unit is told apart from it", () => {
  const picture = pictureOf(
    aFrame([aNode({ node: "E7-1", callsign: null }), aNode({ node: "ff2", callsign: "E7-1" })]),
  );
  expect(names(picture)).toEqual({ "E7-1": "E7-1", ff2: "E7-1 (ff2)" });
});

test("once nobody else is called so, or the other has left, the callsign is what it was given", () => {
  const picture = pictureOf(aFrame(alike));
  const renamed = withDelta(picture, aDelta([aNode({ node: "imu9", callsign: "E7-2" })]));
  expect(names(renamed)).toEqual({ imu7: "E7-1", imu9: "E7-2" });
  expect(names(withDelta(renamed, aDelta([alike[1] ?? aNode()])))).toEqual(names(picture));
  const left = aNode({ node: "imu7", callsign: "E7-1", status: "retired" });
  expect(names(withDelta(picture, aDelta([left])))).toEqual({ imu7: "E7-1", imu9: "E7-1" });
});

test("who is told apart stays so while deltas come", () => {
  let picture = pictureOf(aFrame(alike));
  for (const node of [0, 1, 0, 0]) picture = withDelta(picture, aDelta([alike[node] ?? aNode()]));
  expect(names(picture)).toEqual({ imu7: "E7-1 (imu7)", imu9: "E7-1 (imu9)" });
});

test("breadcrumbs may be called alike", () => {
  const crumbs = ["b1", "b2"].map((node) => aNode({ node, role: "breadcrumb", callsign: "BC" }));
  expect(names(pictureOf(aFrame(crumbs)))).toEqual({ b1: "BC", b2: "BC" });
});

test("who calls in another incident is told apart from who is called alike there", () => {
  const there = glimpseOf(anIncident(), aFrame(alike, { alarms: [anAlarm({ node: "imu9" })] }), 0);
  expect([...there.names]).toEqual([["imu9", "E7-1 (imu9)"]]);
});
