import { expect, test } from "vitest";
import { behindInWords, untilSet } from "./behind";

test("a clock that is behind is told with its gateway, by how much, and what to do", () => {
  const hour = { gateway: "engine-7", behind_s: 3600, clock_of: "gateway" as const };
  expect(behindInWords(hour)).toBe("Clock of gateway engine-7 is 60 min behind: set it.");
  expect(behindInWords({ ...hour, behind_s: 42, clock_of: "units" })).toBe(
    "Clocks of the units heard by gateway engine-7 are 42 s behind: set them.",
  );
});

test("it is said whom that concerns", () => {
  expect(untilSet(1)).toContain("whoever it hears is shown as stale or lost");
  expect(untilSet(2)).toContain("whoever they hear");
});
