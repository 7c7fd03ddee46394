import { expect, test } from "vitest";
import { BELIEVED_AFTER_MS, heard, incidentTime } from "./clock";

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

const RUNNING = { t: 100, localMs: 5000, rate: 1 };

test("a word that was long under way does not set a live clock back, a quicker one sets it forward", () => {
  const late = heard(RUNNING, 101, 9000, 1);
  expect(incidentTime(late, 9000)).toBe(104);
  expect(incidentTime(late, 8900)).toBe(104);
  expect(heard(RUNNING, 104.5, 9000, 1)).toEqual({ t: 104.5, localMs: 9000, rate: 1 });
});

test("a server whose clock has been set back is believed in the end", () => {
  const [halfMs, localMs] = [5000 + BELIEVED_AFTER_MS / 2, 5000 + BELIEVED_AFTER_MS];
  expect(heard(heard(RUNNING, 90, halfMs, 1), 90, localMs, 1)).toEqual({ t: 90, localMs, rate: 1 });
});

test("a clock that stands is set to whatever is told: an incident that was closed ended before", () => {
  expect(heard(RUNNING, 101, 9000, 0)).toEqual({ t: 101, localMs: 9000, rate: 0 });
  expect(heard({ ...RUNNING, rate: 0 }, 60, 9000, 1)).toEqual({ t: 60, localMs: 9000, rate: 1 });
});
