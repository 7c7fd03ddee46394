import { expect, test } from "vitest";
import { Sleep } from "./sleep";

test("a device sleeps while its wall clock goes on and its monotonic one does not", () => {
  const sleep = new Sleep(1_000_000, 0);
  expect(sleep.since(1_000_500, 500)).toBe(0);
  expect(sleep.since(1_600_600, 600)).toBe(600_000);
  expect(sleep.since(1_601_100, 1100)).toBe(0);
});

test("timers that are late, or a wall clock that is set back, are no sleep", () => {
  const sleep = new Sleep(1_000_000, 0);
  expect(sleep.since(1_060_000, 60_000)).toBe(0);
  expect(sleep.since(900_000, 61_000)).toBe(0);
});
