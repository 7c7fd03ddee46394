import { describe, expect, test } from "vitest";
import * as views from "./view";

const view: views.View = { east_m: 10, north_m: -5, pixelsPerMetre: 8, width: 800, height: 600, text: 1 };
const margins: views.Margins = { left: 100, right: 20, top: 40, bottom: 60 };

test("east is right and north is up", () => {
  const [x, y] = views.toScreen(view, 11, -4);
  expect([x, y]).toEqual([408, 292]);
});

test("a pixel and its place in metres are each other's inverse", () => {
  const [e, n] = views.toLocal(view, 123, 456);
  expect(views.toScreen(view, e, n)[0]).toBeCloseTo(123);
  expect(views.toScreen(view, e, n)[1]).toBeCloseTo(456);
});

test("what was under the finger stays under it while the map is dragged", () => {
  const under = views.toLocal(view, 300, 200);
  const after = views.toLocal(views.pan(view, 30, -70), 330, 130);
  expect(after[0]).toBeCloseTo(under[0]);
  expect(after[1]).toBeCloseTo(under[1]);
});

test.each([1.4, 0.3, 1e9, 1e-9])("zooming by %d keeps the place under the pointer", (factor) => {
  const under = views.toLocal(view, 120, 500);
  const zoomed = views.zoomAbout(view, factor, 120, 500);
  expect(views.toLocal(zoomed, 120, 500)[0]).toBeCloseTo(under[0]);
  expect(views.toLocal(zoomed, 120, 500)[1]).toBeCloseTo(under[1]);
  expect(zoomed.pixelsPerMetre).toBeLessThanOrEqual(views.MAX_PIXELS_PER_METRE);
  expect(zoomed.pixelsPerMetre).toBeGreaterThanOrEqual(views.MIN_PIXELS_PER_METRE);
});

test("two fingers without a turn keep the places under both", () => {
  const pinched = views.pinch(
    view,
    [
      [100, 100],
      [200, 100],
    ],
    [
      [150, 180],
      [350, 180],
    ],
  );
  expect(pinched.pixelsPerMetre).toBeCloseTo(16);
  for (const [before, after] of [
    [
      [100, 100],
      [150, 180],
    ],
    [
      [200, 100],
      [350, 180],
    ],
  ] as const) {
    const place = views.toLocal(view, before[0], before[1]);
    expect(views.toScreen(pinched, place[0], place[1])[0]).toBeCloseTo(after[0]);
    expect(views.toScreen(pinched, place[0], place[1])[1]).toBeCloseTo(after[1]);
  }
});

describe("fitting", () => {
  const bounds: views.Bounds = { west_m: -20, east_m: 60, south_m: 0, north_m: 30 };

  test("puts all corners inside the margins and needs no second fit", () => {
    const fitted = views.fitted(view, bounds, margins);
    const [left, bottom] = views.toScreen(fitted, bounds.west_m, bounds.south_m);
    const [right, top] = views.toScreen(fitted, bounds.east_m, bounds.north_m);
    expect(left).toBeGreaterThanOrEqual(99.99);
    expect(right).toBeLessThanOrEqual(780.01);
    expect(top).toBeGreaterThanOrEqual(39.99);
    expect(bottom).toBeLessThanOrEqual(540.01);
    expect(views.fitsWell(fitted, bounds, margins)).toBe(true);
  });

  test("is wanted again once somebody walks off the map, or all have come close together", () => {
    const fitted = views.fitted(view, bounds, margins);
    expect(views.fitsWell(fitted, { ...bounds, east_m: 200 }, margins)).toBe(false);
    expect(views.fitsWell(fitted, { west_m: 0, east_m: 8, south_m: 0, north_m: 8 }, margins)).toBe(false);
  });

  test("to more than must be seen is not wanted again for that, nor when what is more grows", () => {
    const whole = { west_m: -60, east_m: 100, south_m: -25, north_m: 55 };
    const fitted = views.fitted(view, whole, margins);
    expect(views.fitsWell(fitted, bounds, margins)).toBe(false);
    expect(views.fitsWell(fitted, bounds, margins, whole)).toBe(true);
    expect(views.fitsWell(fitted, bounds, margins, { ...whole, east_m: 140 })).toBe(true);
  });

  test("does not fill the map with one lone responder", () => {
    const alone = { west_m: 3, east_m: 3, south_m: 4, north_m: 4 };
    expect(views.fitted(view, alone, margins).pixelsPerMetre).toBeLessThan(60);
  });
});

describe("fitting beside the buttons on the map", () => {
  const tablet = views.resize(views.FIRST_VIEW, 704, 604);
  const usual = views.marginsOf(tablet);
  const choices = views.narrowerMargins(tablet, usual);
  const best = (bounds: views.Bounds, hides: (fit: views.View) => boolean) => {
    const fit = views.fittedFreely(tablet, bounds, choices, (seen) => !hides(seen));
    if (fit === null) throw new Error("there is none");
    return fit;
  };
  const house: views.Bounds = { west_m: 0, east_m: 60, south_m: 0, north_m: 20 };

  test("a long house is shown almost twice as large where nobody in it lies under a button", () => {
    const large = best(house, () => false).pixelsPerMetre;
    expect(large / views.fitted(tablet, house, usual).pixelsPerMetre).toBeGreaterThan(1.6);
  });

  test("where one would lie under the storeys, the map begins beside them, and ends where it may", () => {
    const seen = best(house, (shown) => views.toScreen(shown, 0, 20)[0] < 190);
    expect(views.toScreen(seen, 0, 20)[0]).toBeGreaterThanOrEqual(190);
    expect(views.toScreen(seen, 60, 20)[0]).toBeCloseTo(704 - 130);
  });

  test("where nobody could be kept clear of them, there is none", () => {
    expect(views.fittedFreely(tablet, house, choices, () => false)).toBeNull();
  });

  test("one who would lie under them in the middle of the map is moved, as little as will do", () => {
    const inTheMiddle = views.toScreen(
      best(house, () => false),
      0,
      0,
    )[1];
    const moved = best(house, (shown) => views.toScreen(shown, 0, 0)[1] > inTheMiddle - 40);
    expect(moved.pixelsPerMetre).toBe(best(house, () => false).pixelsPerMetre);
    expect(inTheMiddle - views.toScreen(moved, 0, 0)[1]).toBeGreaterThan(40);
    expect(views.toScreen(moved, 0, 20)[1]).toBeGreaterThan(usual.top);
  });

  test("a phone has its buttons above and below, and no narrower margins", () => {
    expect(views.narrowerMargins(views.resize(views.FIRST_VIEW, 390, 380), usual)).toEqual([usual]);
  });
});

test("the map moves to a selected node only if something covers it, and then to the middle of what is free", () => {
  expect(views.bringIntoView(view, 10, -5, margins)).toBe(view);
  const moved = views.bringIntoView(view, 500, 0, margins);
  expect(moved.pixelsPerMetre).toBe(view.pixelsPerMetre);
  const [x, y] = views.toScreen(moved, 500, 0);
  expect(x).toBeCloseTo((margins.left + view.width - margins.right) / 2);
  expect(y).toBeCloseTo((margins.top + view.height - margins.bottom) / 2);
});

test("bounds hold every position, and there are none of nothing", () => {
  const positions: [number, number, number][] = [
    [1, 2, 0],
    [-3, 8, 0],
  ];
  expect(views.boundsOf(positions)).toEqual({ west_m: -3, east_m: 1, south_m: 2, north_m: 8 });
  expect(views.boundsOf([])).toBeNull();
});
