import { expect, test } from "vitest";
import type { Track } from "../types";
import { Trail, Trails } from "./trails";

const track = (node: string, times: number[]): Track => ({
  node,
  points: times.map((t) => [t, t, -t, 0, 1, 0, 0, 1, 0, 1]),
});

const timesOf = (trail: Trail | undefined) =>
  Array.from({ length: trail?.length ?? 0 }, (_, i) => trail?.time(i));

test("a full trail forgets its oldest points and keeps the order", () => {
  const trail = new Trail();
  for (let t = 0; t < 2000; t += 1) trail.add(t, t, -t);
  expect(trail.length).toBe(1800);
  expect([trail.time(0), trail.time(1799)]).toEqual([200, 1999]);
  expect([trail.east(0), trail.north(0)]).toEqual([200, -200]);
});

test("points that come late or too close upon each other are left out", () => {
  const trail = new Trail();
  for (const t of [10, 10.1, 9, 10.5]) trail.add(t, 0, 0);
  expect(timesOf(trail)).toEqual([10, 10.5]);
});

test("a trail of chosen length begins at the first point inside it", () => {
  const trail = new Trail();
  for (const t of [0, 10, 20, 30]) trail.add(t, 0, 0);
  expect([-5, 10, 11, 31].map((t) => trail.firstFrom(t))).toEqual([0, 1, 2, 4]);
});

test("a full trail is searched across the seam of its buffer", () => {
  const trail = new Trail();
  for (let t = 0; t < 2500; t += 1) trail.add(t, 0, 0);
  expect(trail.time(trail.firstFrom(1900))).toBe(1900);
});

test("recorded tracks come before what was seen while they were fetched", () => {
  const trails = new Trails();
  trails.add("ff1", 30, [30, -30, 0]);
  trails.fill([track("ff1", [10, 20, 30]), track("ff2", [5])]);
  expect(timesOf(trails.of("ff1"))).toEqual([10, 20, 30]);
  expect(timesOf(trails.of("ff2"))).toEqual([5]);
});

test("another incident begins without trails", () => {
  const trails = new Trails();
  trails.add("ff1", 1, [0, 0, 0]);
  trails.clear();
  expect(trails.of("ff1")).toBeUndefined();
});
