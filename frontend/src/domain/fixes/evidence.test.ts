import { expect, test } from "vitest";
import { NOON } from "../samples";
import type { Advice, Evidence, Measurement, Suggestion } from "../types";
import { adviceWords, evidenceList } from "./evidence";

const name = (node: string) => node.toUpperCase();

function aMeasurement(over: Partial<Measurement> = {}): Measurement {
  const read = { value: 7.3, residual: 0.4, sigma: 0.3, weight: 0.97, share: 0.1 };
  return { kind: "range", t: NOON, a: "ff1", b: "bc1", ...read, ...over };
}

function anEvidence(held: Measurement[], rejected: Measurement[] = []): Evidence {
  const where = { position_m: [0, 0, 0] as [number, number, number] };
  const rest = 1 - held.reduce((sum, { share }) => sum + share, 0);
  return { node: "ff1", t: NOON, ...where, covariance_m2: [1, 0, 0, 1, 0, 1], held, rejected, rest };
}

function anAdvice(...suggestions: Suggestion[]): Advice {
  return { node: "ff1", t: NOON, sigma_m: 3, suggestions };
}

function what(over: Partial<Measurement>): string | undefined {
  return evidenceList(anEvidence([aMeasurement(over)]), name).held[0]?.what;
}

function off(over: Partial<Measurement>): string | undefined {
  return evidenceList(anEvidence([aMeasurement(over)]), name).held[0]?.off;
}

test("a measurement is called by what it is, and by the node at its other end", () => {
  expect(what({})).toBe("Range to BC1");
  expect(what({ a: "bc1", b: "ff1" })).toBe("Range to BC1");
  expect(what({ kind: "bearing", a: "uav1", b: "ff1" })).toBe("Bearing from UAV1");
  expect(what({ kind: "rssi", a: "ff2", b: "ff1" })).toBe("Radio signal with FF2");
  expect(what({ kind: "reach", a: "ff1", b: "bc1" })).toBe("Edge of reach of BC1");
  expect(what({ kind: "drop", a: "bc4", b: "ff1" })).toBe("Dropped BC4 here");
});

test("what a node measured by itself names nobody else", () => {
  expect(what({ kind: "displacement", b: null })).toBe("Own steps");
  expect(what({ kind: "displacement", b: "ff1" })).toBe("Own steps");
  expect(what({ kind: "height", b: null })).toBe("Height");
  expect(what({ kind: "straightness", b: null })).toBe("Straight walk");
});

test("a measurement between others names both, or the one it is about", () => {
  expect(what({ a: "bc1", b: "base" })).toBe("Range BC1 – BASE");
  expect(what({ kind: "fix", a: "uav1", b: null })).toBe("Position fix, UAV1");
});

test.each([
  [{ residual: 1.24 }, "1.2 m too long"],
  [{ residual: -1.24 }, "1.2 m too short"],
  [{ residual: 0.04 }, "fits"],
  [{ kind: "rssi", residual: -7.6 }, "8 dB too weak"],
  [{ kind: "rssi", residual: 3 }, "3 dB too strong"],
  [{ kind: "reach", residual: 1.2 }, "1.2 m too near"],
  [{ kind: "height", residual: 2 }, "2.0 m too high"],
  [{ kind: "bearing", residual: -0.2 }, "11° off"],
  [{ kind: "displacement", residual: -0.3 }, "0.3 m off"],
  [{ kind: "stillness", residual: 0.0001 }, "fits"],
  [{ kind: "straightness", residual: -0.0052 }, "0.3 °/s off"],
] as const)("%o reads %s", (over, text) => {
  expect(off(over)).toBe(text);
});

test("only a few are listed, and the rest adds up to all", () => {
  const held = [0.3, 0.2, 0.1, 0.1, 0.05, 0.05, 0.02].map((share) => aMeasurement({ share }));
  const rejected = [1, 2, 3, 4, 5].map((residual) => aMeasurement({ residual, weight: 0.01, share: 0 }));
  const list = evidenceList(anEvidence(held, rejected), name);
  expect(list.held.map(({ share }) => share)).toEqual([0.3, 0.2, 0.1, 0.1, 0.05]);
  expect(list.rest).toBeCloseTo(0.25);
  expect(list.rejected.map((line) => line.off)).toEqual([
    "1.0 m too long",
    "2.0 m too long",
    "3.0 m too long",
  ]);
  expect(list.moreRejected).toBe(2);
});

test("what holds next to nothing gets no line, unless there is nothing else", () => {
  const shares = (...of: number[]) =>
    evidenceList(anEvidence(of.map((share) => aMeasurement({ share }))), name).held.map(({ share }) => share);
  expect(shares(0.97, 0.01, 0.004)).toEqual([0.97, 0.01]);
  expect(shares(0.004, 0.003)).toEqual([0.004]);
});

test("the rest is never less than nothing", () => {
  const list = evidenceList(anEvidence([aMeasurement({ share: 1 + 1e-9 })]), name);
  expect(list.rest).toBe(0);
  expect(list.moreRejected).toBe(0);
});

test("the best piece of advice is said in one line", () => {
  const drop: Suggestion = { action: "drop", by: "l3-2", position_m: [1, 2, 3], sigma_m: 2.3, gain: 0.4 };
  const uav: Suggestion = { action: "uav", by: null, position_m: [12, -4, 10], sigma_m: 2.9, gain: 0.07 };
  expect(adviceWords(anAdvice(drop, uav), name)).toBe(
    "A breadcrumb by L3-2 would make FF1 surer: typical error 2.3 m instead of 3.0 m.",
  );
  expect(adviceWords(anAdvice(uav), name).replaceAll("\u00a0", " ")).toBe(
    "A UAV at 12.0 m E, 4.0 m S, 10.0 m up would make FF1 surer: typical error 2.9 m instead of 3.0 m.",
  );
});

test("for what would gain less than the screen shows nobody is sent", () => {
  const drop: Suggestion = { action: "drop", by: "l3-2", position_m: [1, 2, 3], sigma_m: 2.97, gain: 0.02 };
  expect(adviceWords(anAdvice(drop), name).replaceAll("\u00a0", " ")).toBe(
    "Nothing at hand would make FF1 surer: typical error 3.0 m.",
  );
});

test("where nothing helps, that is what is said", () => {
  const idle: Suggestion = { action: "drop", by: "l3-2", position_m: [1, 2, 3], sigma_m: 3, gain: 0 };
  const nothing = "Nothing at hand would make FF1 surer: typical error 3.0 m.";
  expect(adviceWords(anAdvice(), name)).toBe(nothing);
  expect(adviceWords(anAdvice(idle), name)).toBe(nothing);
});
