import { expect, test } from "vitest";
import { backoffMs } from "./backoff";

test("the wait doubles with every failed attempt up to 8 s", () => {
  expect([0, 1, 2, 5, 50].map((attempt) => backoffMs(attempt, 1))).toEqual([300, 600, 1200, 8000, 8000]);
});

test("screens that lost the server together come back at different times, none at once", () => {
  expect(backoffMs(3, 0)).toBe(1200);
  expect(backoffMs(3, 0.5)).toBe(1800);
});
