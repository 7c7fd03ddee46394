import { expect, test } from "vitest";
import { STOREYS } from "../samples";
import { mapInWords } from "./describe";

const counts = { responders: 6, live: 4, stale: 1, lost: 1, left: 0 };

test("the map says in words who is where and who is in trouble", () => {
  expect(mapInWords(counts, 1, 12, 1, STOREYS, "live")).toBe(
    "Map of Level 1: 6 responders, 4 live, 1 stale, 1 lost, 12 breadcrumbs, 1 alarm",
  );
});

test("one is one, and no alarm is said", () => {
  const one = { responders: 1, live: 1, stale: 0, lost: 0, left: 0 };
  expect(mapInWords(one, 0, 1, "all", STOREYS, "live")).toBe(
    "Map of all storeys: 1 responder, 1 live, 0 stale, 0 lost, 1 breadcrumb, no alarm",
  );
});

test("whose air is low is counted where there is anybody", () => {
  expect(mapInWords(counts, 0, 0, "all", STOREYS, "live", 2)).toContain("no alarm, 2 low on air");
});

test("of an incident that is over it says who was live", () => {
  expect(mapInWords(counts, 0, 0, "all", STOREYS, "closed")).toContain("6 responders, 4 were live, 1 stale");
});
