/** Uncertainty as the commander sees it: the 95 % ellipse, and circular and vertical errors. */
import type { Covariance } from "./types";
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

/** The border is looked at in so many places. */
const LOOKED_AT = 32;

/** The share of an ellipse's border about a place (east, north; m) that lies on the map, from 0 to 1. */
export function borderOnMap(
  view: View,
  [e_m, n_m]: readonly [number, number, ...number[]],
  ellipse: Ellipse,
): number {
  const [cos, sin] = [Math.cos(ellipse.angle_rad), Math.sin(ellipse.angle_rad)];
  let seen = 0;
  for (let at = 0; at < LOOKED_AT; at += 1) {
    const turn = (2 * Math.PI * at) / LOOKED_AT;
    const [along, across] = [ellipse.major_m * Math.cos(turn), ellipse.minor_m * Math.sin(turn)];
    const [x, y] = toScreen(view, e_m + along * cos - across * sin, n_m + along * sin + across * cos);
    if (x >= 0 && y >= 0 && x <= view.width && y <= view.height) seen += 1;
  }
  return seen / LOOKED_AT;
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
