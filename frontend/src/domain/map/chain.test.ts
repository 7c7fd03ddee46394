import { expect, test } from "vitest";
import { aNode, pictureWith } from "../samples";
import type { FrameNode } from "../types";
import { relayChain } from "./chain";

const crumb = (node: string, e_m: number, up_m = 0, over: Partial<FrameNode> = {}) =>
  aNode({ node, role: "breadcrumb", position_m: [e_m, 0, up_m], ...over });
const base = aNode({ node: "base", role: "base", position_m: [0, 0, 0] });
const pairs = (...nodes: FrameNode[]) =>
  relayChain(pictureWith(...nodes)).map(({ from, to }) => `${from}-${to}`);

test("breadcrumbs chain from the base by nearness, in whatever order they are listed", () => {
  expect(pairs(crumb("b3", 30), crumb("b1", 10), base, crumb("b2", 20))).toEqual([
    "base-b1",
    "b1-b2",
    "b2-b3",
  ]);
});

test("one storey up is not near, though it lies on the same spot of the map", () => {
  expect(pairs(base, crumb("b1", 5), crumb("above", 5, 20), crumb("b2", 12))).toEqual([
    "base-b1",
    "b1-b2",
    "b1-above",
  ]);
});

test("breadcrumbs without a position, those that are gone and responders relay nothing", () => {
  const none = crumb("b1", 0, 0, { position_m: null });
  const gone = crumb("b2", 2, 0, { status: "retired" });
  expect(pairs(base, none, gone, aNode())).toEqual([]);
});

test("without a base the chain still holds together", () => {
  expect(pairs(crumb("b1", 0), crumb("b2", 4))).toEqual(["b1-b2"]);
});
