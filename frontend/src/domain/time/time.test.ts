import { afterEach, expect, test, vi } from "vitest";
import { NOON } from "../samples";
import { beforeEnd, clockTime, dateTime, day, midnights, timeIn, utc, zoneNearChange } from "./time";

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

test("of an incident that goes on over midnight a time is told with its day, and midnight is known", () => {
  vi.stubEnv("TZ", "Europe/Prague");
  const midnight = new Date(2026, 0, 6, 0, 0, 0).getTime() / 1000;
  const evening = { from: midnight - 7200, to: midnight - 1 };
  const night = { from: midnight - 7200, to: midnight + 3600 };
  expect(timeIn(evening, midnight - 60)).toBe(clockTime(midnight - 60));
  expect(timeIn(night, midnight - 60)).toBe(dateTime(midnight - 60));
  expect([midnights(evening), midnights(night)]).toEqual([[], [midnight]]);
});

test("midnights are as far apart as the days are long, and those of a wrong clock are none", () => {
  vi.stubEnv("TZ", "Europe/Prague");
  const from = new Date(2025, 9, 25, 20, 0, 0).getTime() / 1000;
  const found = midnights({ from, to: from + 2 * 86_400 });
  expect(found.map((t) => t - from)).toEqual([4 * 3600, 29 * 3600]);
  expect(midnights({ from: 5, to: from })).toEqual([]);
});

test.each([
  [0, "0:00"],
  [-3, "0:00"],
  [65, "−1:05"],
  [3661, "−1:01:01"],
])("%d s before the end reads %s", (seconds, text) => {
  expect(beforeEnd(seconds)).toBe(text);
});
