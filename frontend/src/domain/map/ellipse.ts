/** Uncertainty as the commander sees it: the 95 % ellipse, and circular and vertical errors. */
import type { Covariance } from "../types";
import { toScreen, type View } from "./view";

/** Scale of the 95 % ellipse: the square root of the 0.95 quantile of chi-squared with two degrees of freedom. */
export const K95 = 2.448;
const VE95 = 1.96;

export interface Ellipse {
  /** Semi-axes of the 95 % ellipse (m). */
  readonly major_m: number;
  readonly minor_m: number;
  /** Direction of the major axis, from east, anticlockwise (rad), in (-π/2, π/2]. */
  readonly angle_rad: number;
}

/** The horizontal 95 % ellipse of a covariance `[ee, en, eu, nn, nu, uu]` (m²). */
export function ellipseOf([ee, en, , nn]: Covariance): Ellipse {
  const mean = (ee + nn) / 2;
  const spread = Math.hypot((ee - nn) / 2, en);
  return {
    major_m: K95 * Math.sqrt(Math.max(0, mean + spread)),
    minor_m: K95 * Math.sqrt(Math.max(0, mean - spread)),
    angle_rad: Math.atan2(2 * en, ee - nn) / 2,
  };
}

/** The border is looked at in so many places: their directions, worked out once for all frames of the screen. */
const LOOKED_AT = Array.from({ length: 32 }, (_, at) => (2 * Math.PI * at) / 32).map(
  (turn) => [Math.cos(turn), Math.sin(turn)] as const,
);

/** The share of an ellipse's border about a place (east, north; m) that lies on the map, from 0 to 1. */
export function borderOnMap(
  view: View,
  [e_m, n_m]: readonly [number, number, ...number[]],
  { major_m, minor_m, angle_rad }: Ellipse,
): number {
  const [cos, sin] = [Math.cos(angle_rad), Math.sin(angle_rad)];
  const seen = LOOKED_AT.filter(([along, across]) => {
    const [a_m, b_m] = [major_m * along, minor_m * across];
    const [x, y] = toScreen(view, e_m + a_m * cos - b_m * sin, n_m + a_m * sin + b_m * cos);
    return x >= 0 && y >= 0 && x <= view.width && y <= view.height;
  });
  return seen.length / LOOKED_AT.length;
}

/**
 * Radius of the circle about the fix that holds 95 % (m), within 0.2 %.
 * Leenhouts, "On the computation of bi-normal radial error", Navigation 32 (1985): cubic in the ratio
 * of the semi-axes.
 */
export function ce95(covariance: Covariance): number {
  const { major_m, minor_m } = ellipseOf(covariance);
  if (major_m === 0) return 0;
  const ratio = minor_m / major_m;
  const factor = 1.960787 + ratio * (0.004121 + ratio * (0.114276 + ratio * 0.371625));
  return (factor * major_m) / K95;
}

/** Half-width of the vertical interval that holds 95 % (m). */
export function ve95(covariance: Covariance): number {
  return VE95 * Math.sqrt(Math.max(0, covariance[5]));
}
