import { expect, test } from "vitest";
import { fillShare } from "./ellipses";

const MAP_PX2 = 704 * 605;
const lost = { majorPx: 4000, minorPx: 4000, fill: 0.03, urgent: false };
const sure = { majorPx: 20, minorPx: 18, fill: 0.15, urgent: false };

test("whoever is lost alone, or found among many, has a whole fill", () => {
  expect(fillShare([lost], MAP_PX2)).toBe(1);
  expect(fillShare(Array(50).fill(sure), MAP_PX2)).toBe(1);
  expect(fillShare([], MAP_PX2)).toBe(1);
});

test("however many are lost, they tint the map no more than two of them would", () => {
  const many = Array(40).fill(lost);
  expect(40 * lost.fill * fillShare(many, MAP_PX2)).toBeCloseTo(2 * lost.fill);
});

test("one in alarm among them takes nothing from the others", () => {
  const alarm = { ...lost, urgent: true };
  expect(fillShare([alarm, alarm, alarm, lost], MAP_PX2)).toBe(1);
});
