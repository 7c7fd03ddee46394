import { expect, test } from "vitest";
import { incidentTime } from "./clock";

test("between two words of the server a live incident goes on by the local clock", () => {
  expect(incidentTime({ t: 100, localMs: 5000, rate: 1 }, 7500)).toBe(102.5);
});

test("a replay goes on at its speed, a paused one stands still", () => {
  expect(incidentTime({ t: 100, localMs: 0, rate: 8 }, 500)).toBe(104);
  expect(incidentTime({ t: 100, localMs: 0, rate: 0 }, 500)).toBe(100);
});

test("time never runs past the end of a replay", () => {
  expect(incidentTime({ t: 100, localMs: 0, rate: 32, limitT: 110 }, 60_000)).toBe(110);
});

test("a local clock read before the last word does not turn time back", () => {
  expect(incidentTime({ t: 100, localMs: 5000, rate: 1 }, 4000)).toBe(100);
});
