import { expect, test } from "vitest";
import { FIRST_VIEW, fitted, marginsOf, narrowerMargins, resize, toScreen } from "../domain/map/view";
import { coverage, fittedClear, isAnybodyCovered, isCovered } from "./covered";

const TABLET = resize(FIRST_VIEW, 704, 604);
const MARGINS = narrowerMargins(TABLET, marginsOf(TABLET));
const STOREYS = { x: 0, y: 0, width: 185, height: 205 };
const CONTROLS = { x: 600, y: 400, width: 104, height: 204 };
const BUTTONS = [STOREYS, CONTROLS];

function at(...places: [east_m: number, north_m: number][]) {
  return places.map(([e, n], i) => ({
    node: `ff${i}`,
    role: "responder" as const,
    position_m: [e, n, 0] as [number, number, number],
    covariance_m2: null,
  }));
}

test("a mark that reaches under a button is covered, and nothing is by a button that is not there", () => {
  expect(isCovered(BUTTONS, [200, 100], 24)).toBe(true);
  expect(isCovered(BUTTONS, [210, 100], 24)).toBe(false);
  expect(isCovered([{ ...STOREYS, height: 0 }], [10, 10], 24)).toBe(false);
});

test.each([
  ["along a corridor", at([0, 0], [60, 0])],
  ["in all corners of a house", at([0, 0], [60, 0], [0, 40], [60, 40])],
  ["up a slope to the left, towards the storeys", at([0, 40], [60, 0])],
])("nobody %s lies under a button of a map that has just been fitted", (_, crew) => {
  const [e, n] = [crew.map(({ position_m }) => position_m[0]), crew.map(({ position_m }) => position_m[1])];
  const bounds = {
    west_m: Math.min(...e),
    east_m: Math.max(...e),
    south_m: Math.min(...n),
    north_m: Math.max(...n),
  };
  const fit = fittedClear(TABLET, crew, [], bounds, MARGINS, BUTTONS);
  expect(isAnybodyCovered(crew, fit, BUTTONS, 13)).toBe(false);
  for (const { position_m } of crew) {
    const [x, y] = toScreen(fit, position_m[0], position_m[1]);
    expect([x >= 0, y >= 0, x <= 704, y <= 604]).toEqual([true, true, true, true]);
  }
});

test("a corridor has the width of the map where it runs between the buttons", () => {
  const crew = at([0, 0], [60, 0]);
  const bounds = { west_m: 0, east_m: 60, south_m: 0, north_m: 0 };
  const fit = fittedClear(TABLET, crew, [], bounds, MARGINS, BUTTONS);
  expect(fit.pixelsPerMetre).toBeCloseTo((704 - 70 - 130) / 60);
});

test("a UAV lies under no button either, and people are hardly smaller for it", () => {
  const [crew, uav] = [at([0, 0], [60, 0]), at([66, -14])];
  const bounds = { west_m: 0, east_m: 60, south_m: 0, north_m: 0 };
  const without = fittedClear(TABLET, crew, [], bounds, MARGINS, BUTTONS);
  expect(isAnybodyCovered(uav, without, BUTTONS, 13)).toBe(true);
  const fit = fittedClear(TABLET, crew, uav, bounds, MARGINS, BUTTONS);
  expect(coverage(crew, uav, fit, BUTTONS, 13)).toBe(0);
  expect(fit.pixelsPerMetre).toBeGreaterThan(0.8 * without.pixelsPerMetre);
});

test("people are not made much smaller for a UAV", () => {
  const [crew, column] = [
    at([0, 0], [60, 0]),
    at(...Array.from({ length: 31 }, (_, i): [number, number] => [69, 60 - 4 * i])),
  ];
  const bounds = { west_m: 0, east_m: 60, south_m: 0, north_m: 0 };
  const fit = fittedClear(TABLET, crew, column, bounds, MARGINS, BUTTONS);
  expect(fit).toEqual(fittedClear(TABLET, crew, [], bounds, MARGINS, BUTTONS));
  expect(coverage(crew, column, fit, BUTTONS, 13)).toBe(1);
  expect(coverage(column, crew, fit, BUTTONS, 13)).toBe(2);
});

test("where nobody can be kept clear of them, the usual margins hold", () => {
  const crew = at([0, 0], [60, 0]);
  const bounds = { west_m: 0, east_m: 60, south_m: 0, north_m: 0 };
  const everywhere = [{ x: 0, y: 0, width: 704, height: 604 }];
  const fit = fittedClear(TABLET, crew, [], bounds, MARGINS, everywhere);
  expect(fit).toEqual(fitted(TABLET, bounds, marginsOf(TABLET)));
});
