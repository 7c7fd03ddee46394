import { afterEach, expect, test, vi } from "vitest";
import { NOON } from "./samples";
import { beforeEnd, clockTime, dateTime, day, utc, zoneNearChange } from "./time";

afterEach(() => {
  vi.unstubAllEnvs();
});

test("a time that comes twice as the clocks are set back is told with its zone, and no other", () => {
  vi.stubEnv("TZ", "Europe/Prague");
  const setBack = Date.UTC(2025, 9, 26, 1) / 1000;
  expect([zoneNearChange(setBack - 1800), zoneNearChange(setBack + 1800)]).toEqual(["UTC+2", "UTC+1"]);
  expect([zoneNearChange(setBack - 86_400), zoneNearChange(NOON)]).toEqual([null, null]);
  vi.stubEnv("TZ", "America/St_Johns");
  expect(zoneNearChange(Date.UTC(2025, 10, 2, 4) / 1000)).toBe("UTC−2:30");
});

test("a time of day is local and has seconds", () => {
  const local = new Date(NOON * 1000);
  const [hours, minutes, seconds] =
    clockTime(NOON + 7)
      .match(/\d+/g)
      ?.map(Number) ?? [];
  expect([hours, minutes, seconds]).toEqual([local.getHours(), local.getMinutes(), 7]);
});

test("midnight is 00, never 24", () => {
  const midnight = new Date(2026, 0, 5, 0, 0, 0).getTime() / 1000;
  expect(clockTime(midnight)).toMatch(/^00/);
});

test("a date names the year and the time", () => {
  expect(dateTime(NOON)).toContain(String(new Date(NOON * 1000).getFullYear()));
  expect(dateTime(NOON)).toContain(clockTime(NOON));
});

test("a day is the local one, and universal time is the same everywhere", () => {
  expect(dateTime(NOON)).toBe(`${day(NOON)}, ${clockTime(NOON)}`);
  expect(utc(NOON + 7.25)).toBe("2025-11-21T08:00:07Z");
});

test.each([
  [0, "0:00"],
  [-3, "0:00"],
  [65, "−1:05"],
  [3661, "−1:01:01"],
])("%d s before the end reads %s", (seconds, text) => {
  expect(beforeEnd(seconds)).toBe(text);
});
