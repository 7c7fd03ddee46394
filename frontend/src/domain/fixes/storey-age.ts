/** How sure a storey is while no word comes from the server: its probability falls as the height becomes unsure. */
import type { Picture, Sighting } from "../picture";
import type { Level } from "../types";
import { covarianceAt } from "./staleness";

/** Of a building whose storeys' floors are not told: from one to the next (m). */
const STOREY_M = 3;
/** Probability of being between the lowest storey and the highest below which the height is not believed. */
const NOWHERE = 1e-12;

/**
 * Probability of the storey of a height, against all others: as the server works it out (estimator/levels.py).
 *
 * A storey reaches halfway to the floors below and above; the lowest and the highest as far to the other side.
 */
export function storeyProbability(levels: readonly Level[], up_m: number, variance_m2: number): number {
  const floors = levels.map((level) => level.up_m).sort((a, b) => a - b);
  const between = floors.slice(1).map((above, at) => (above + (floors[at] ?? above)) / 2);
  const [lowest = 0, highest = 0] = [floors[0], floors.at(-1)];
  const below = between[0] === undefined ? STOREY_M / 2 : between[0] - lowest;
  const above = between.length === 0 ? STOREY_M / 2 : highest - (between.at(-1) ?? highest);
  const sigma_m = Math.max(Math.sqrt(Math.max(variance_m2, 0)), 1e-3);
  const under = [lowest - below, ...between, highest + above].map((edge) => normal((edge - up_m) / sigma_m));
  const shares = under.slice(1).map((until, at) => until - (under[at] ?? 0));
  const inside = shares.reduce((sum, share) => sum + share, 0);
  const own = shares[between.filter((edge) => edge < up_m).length] ?? 0;
  return inside > NOWHERE ? Math.min(Math.max(own / inside, 0), 1) : 1;
}

/** The picture with the storeys of those who move as sure as they are at `now`; the very same where none has aged. */
export function withStoreysAged(
  picture: Picture | null,
  now: number,
  levels: readonly Level[],
): Picture | null {
  if (picture === null || levels.length === 0) return picture;
  const aged = [...picture.nodes].flatMap(([node, sighting]): [string, Sighting][] => {
    const { state } = sighting;
    const covariance = covarianceAt(sighting, now);
    if (state.level_p == null || state.position_m == null || covariance === null) return [];
    if (covariance === state.covariance_m2) return [];
    const level_p = storeyProbability(levels, state.position_m[2], covariance[5]);
    return [[node, { ...sighting, state: { ...state, level_p } }]];
  });
  return aged.length === 0 ? picture : { ...picture, nodes: new Map([...picture.nodes, ...aged]) };
}

/** Of the standard normal distribution, within 1.5e-7 (Abramowitz and Stegun, 7.1.26). */
function normal(z: number): number {
  const x = Math.abs(z) / Math.SQRT2;
  const t = 1 / (1 + 0.3275911 * x);
  const sum =
    t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
  const erf = 1 - sum * Math.exp(-x * x);
  return 0.5 * (1 + Math.sign(z) * erf);
}
