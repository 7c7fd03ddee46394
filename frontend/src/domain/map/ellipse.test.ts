import { describe, expect, test } from "vitest";
import type { Covariance } from "../types";
import { borderOnMap, ce95, ellipseOf, K95, ve95 } from "./ellipse";
import { FIRST_VIEW, type View } from "./view";

/** The covariance with these standard deviations along and across a direction. */
function turned(along_m: number, across_m: number, angle_rad: number): Covariance {
  const [c, s] = [Math.cos(angle_rad), Math.sin(angle_rad)];
  const [a, b] = [along_m ** 2, across_m ** 2];
  return [a * c * c + b * s * s, (a - b) * c * s, 0, a * s * s + b * c * c, 0, 0];
}

/** Probability inside a circle of radius r, integrated over the direction (midpoint rule). */
function inside(r: number, along_m: number, across_m: number): number {
  const steps = 20_000;
  let sum = 0;
  for (let i = 0; i < steps; i += 1) {
    const angle = ((i + 0.5) / steps) * 2 * Math.PI;
    const q = Math.cos(angle) ** 2 / along_m ** 2 + Math.sin(angle) ** 2 / across_m ** 2;
    sum += (1 - Math.exp((-r * r * q) / 2)) / q;
  }
  return sum / (steps * along_m * across_m);
}

describe("the 95 % ellipse", () => {
  test.each([0, 0.4, 1.2, -0.7])("points along its longer axis (%d rad)", (angle) => {
    const ellipse = ellipseOf(turned(3, 1, angle));
    expect(ellipse.major_m).toBeCloseTo(3 * K95, 9);
    expect(ellipse.minor_m).toBeCloseTo(1 * K95, 9);
    expect(ellipse.angle_rad).toBeCloseTo(angle, 9);
  });

  test("points north where north is less sure than east", () => {
    expect(Math.abs(ellipseOf([1, 0, 0, 4, 0, 0]).angle_rad)).toBeCloseTo(Math.PI / 2);
  });

  test("holds 95 % of a circular error", () => {
    expect(1 - Math.exp((-K95 * K95) / 2)).toBeCloseTo(0.95, 4);
  });

  test("has no negative axis where rounding made a covariance indefinite", () => {
    expect(ellipseOf([1, 1.0000001, 0, 1, 0, 0]).minor_m).toBe(0);
  });
});

test.each([1, 0.7, 0.4, 0.1])("the circular error holds 95 %% where the axes are as 1 to %d", (ratio) => {
  expect(inside(ce95(turned(2, 2 * ratio, 0.3)), 2, 2 * ratio)).toBeCloseTo(0.95, 2.7);
});

test("no uncertainty is no circular error", () => {
  expect(ce95([0, 0, 0, 0, 0, 0])).toBe(0);
});

test("the vertical error holds 95 % of a normal error", () => {
  expect(ve95([0, 0, 0, 0, 0, 4])).toBeCloseTo(3.92);
});

describe("of the border of an ellipse", () => {
  /** 60 m from west to east, 40 m from south to north. */
  const map: View = { ...FIRST_VIEW, pixelsPerMetre: 10, width: 600, height: 400 };

  test("all lies on the map where the ellipse does", () => {
    expect(borderOnMap(map, [5, -5], { major_m: 12, minor_m: 3, angle_rad: 1 })).toBe(1);
  });

  test("nothing does where the map lies inside the ellipse", () => {
    expect(borderOnMap(map, [5, -5], { major_m: 200, minor_m: 90, angle_rad: 1 })).toBe(0);
  });

  test("a half does where the place is at the edge of the map", () => {
    const share = borderOnMap(map, [30, 0], { major_m: 8, minor_m: 8, angle_rad: 0 });
    expect(share).toBeGreaterThan(0.45);
    expect(share).toBeLessThan(0.6);
  });

  test("only the long sides do of one that is longer than the map", () => {
    const share = borderOnMap(map, [0, 0], { major_m: 100, minor_m: 5, angle_rad: 0 });
    expect(share).toBeGreaterThan(0);
    expect(share).toBeLessThan(0.5);
  });
});
