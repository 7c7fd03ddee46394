import { expect, test } from "vitest";
import { SHELVED_MS, Shelf } from "./shelf.svelte";

test("what was seen is quiet for a while, and loud again after it", () => {
  const shelf = new Shelf();
  shelf.put(["ff1"], 1000);
  expect([shelf.has("ff1", 1000 + SHELVED_MS - 1), shelf.has("ff2", 1000)]).toEqual([true, false]);
  expect(shelf.has("ff1", 1000 + SHELVED_MS)).toBe(false);
});

test("what went and comes again is news", () => {
  const shelf = new Shelf();
  shelf.put(["ff1", "ff2"], 0);
  shelf.keep(new Set(["ff1"]));
  expect([shelf.has("ff1", 1), shelf.has("ff2", 1)]).toEqual([true, false]);
});
