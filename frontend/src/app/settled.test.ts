import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { SETTLES_MS, Settled } from "./settled.svelte";

beforeEach(() => {
  vi.useFakeTimers();
});

afterEach(() => {
  vi.useRealTimers();
});

test("a button that has changed, or moved up, is not pressed at once", () => {
  const settled = new Settled();
  settled.sees(["a raised", "b raised"]);
  for (const shown of [["a acknowledged", "b raised"], ["b raised"]]) {
    settled.sees(shown);
    expect(settled.yes).toBe(false);
    vi.advanceTimersByTime(SETTLES_MS - 1);
    expect(settled.yes).toBe(false);
    vi.advanceTimersByTime(1);
    expect(settled.yes).toBe(true);
  }
});

test("a call that comes below others, or first of all, can be answered at once", () => {
  const settled = new Settled();
  settled.sees([]);
  settled.sees(["a raised"]);
  settled.sees(["a raised", "b raised"]);
  settled.sees(["a raised", "b raised"]);
  expect(settled.yes).toBe(true);
});
