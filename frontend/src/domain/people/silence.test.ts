import { expect, test } from "vitest";
import { DEFAULT_LIMITS } from "../fixes/staleness";
import { pictureOf } from "../picture";
import { aFrame, aNode, NOON } from "../samples";
import type { FrameMessage, FrameNode } from "../types";
import { silenceInWords, silences, sinceInWords } from "./silence";

function one(node: string, crew: string | null, age_s: number, over: Partial<FrameNode> = {}): FrameNode {
  return aNode({ node, crew, t: NOON - age_s, ...over });
}

function told(nodes: FrameNode[], over: Partial<FrameMessage> = {}) {
  return silences(pictureOf(aFrame(nodes, over)), NOON, DEFAULT_LIMITS);
}

test("that nobody is heard is told once, with the newest word, and leads to the gateways", () => {
  const all = [one("e1", "E7", 90), one("e2", "E7", 92), one("l1", "L3", 95)];
  const [silence, ...others] = told(all);
  expect([silence, others]).toEqual([{ crew: null, age_s: 90 }, []]);
  expect(silence && `${silenceInWords(silence)} ${sinceInWords(silence)}`).toBe(
    "Nobody has been heard for 1 min 30 s: look to the gateways and their links.",
  );
});

test("of crews the one is told of whom nobody is heard, while others are", () => {
  const heard = [one("e1", "E7", 1), one("e2", "E7", 92)];
  expect(told([...heard, one("l1", "L3", 40), one("l2", "L3", 35)])).toEqual([{ crew: "L3", age_s: 35 }]);
  expect(silenceInWords({ crew: "L3", age_s: 35 })).toBe("Nobody of L3 has been heard");
});

test("one who falls silent alone is lost, and tells nothing of a gateway", () => {
  expect(told([one("e1", "E7", 1), one("l1", "L3", 90)])).toEqual([]);
  expect(told([one("e1", "E7", 90)])).toEqual([]);
  expect(told([one("a", null, 90), one("b", null, 90), one("e1", "E7", 1)])).toEqual([]);
});

test("who has left, stands, or is heard and not followed is not silent", () => {
  const out = one("l2", "L3", 900, { status: "retired" });
  const radio = one("b1", "L3", 900, { role: "breadcrumb" });
  expect(told([one("l1", "L3", 1), out, radio])).toEqual([]);
  const aside = { name: "l1", callsign: null, crew: null, gateway: "g", t: NOON, code: "c", text: "clock" };
  expect(told([one("l1", "L3", 90), one("l2", "L3", 90)], { set_aside: [aside] })).toEqual([]);
});

test("who is heard by a clock that is behind is not silent", () => {
  const clock = { gateway: "ladder-3", behind_s: 3600, clock_of: "gateway" as const };
  expect(told([one("l1", "L3", 3600), one("l2", "L3", 3600)], { clocks: [clock] })).toEqual([]);
});
