/** Where somebody was, with everything known now: beside where he was shown then. */
import { ellipseOf, K95 } from "../map/ellipse";
import type { Picture } from "../picture";
import type { Covariance, FrameNode, Level, Position, Track } from "../types";
import { metres } from "../words";
import { storeyUnsure, storeyWords } from "./levels";
import { covarianceAt, isMoving } from "./staleness";
import { storeyProbability } from "./storey-age";

/** Between two points further apart than this nothing is said to be known (s). */
const GAP_S = 15;

export interface KnownNow {
  readonly node: string;
  readonly position: Position;
  readonly covariance: Covariance;
  /** The storey of that height; null where the incident has none. */
  readonly level: number | null;
  readonly level_p: number | null;
  /** How far from where he was shown then (m); null where he was not shown. */
  readonly off_m: number | null;
  /** Outside the 95 % ellipse that was shown. */
  readonly outside: boolean;
  /** On another storey than was shown. */
  readonly otherStorey: boolean;
}

/** The point of a track at `t`, between its two neighbours; null where there are none near enough. */
export function pointAt(
  { points }: Pick<Track, "points">,
  t: number,
): { position: Position; covariance: Covariance } | null {
  let [low, high] = [0, points.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((points[middle]?.[0] ?? 0) <= t) low = middle + 1;
    else high = middle;
  }
  const before = points[low - 1];
  const after = points[low];
  if (before === undefined) return null;
  // A last point, or one before a gap, holds for the second that it begins.
  if (after === undefined || after[0] - before[0] > GAP_S) return t - before[0] <= 1 ? placeOf(before) : null;
  const share = (t - before[0]) / (after[0] - before[0]);
  return placeOf(before.map((value, at) => value + share * ((after[at] ?? value) - value)));
}

function placeOf(point: readonly number[]): { position: Position; covariance: Covariance } {
  const [, e = 0, n = 0, u = 0, ee = 0, en = 0, eu = 0, nn = 0, nu = 0, uu = 0] = point;
  return { position: [e, n, u], covariance: [ee, en, eu, nn, nu, uu] };
}

/** Everybody who moves, as known now, of whom a picture tells. */
export function knownNow(
  tracks: readonly Track[],
  picture: Picture | null,
  now: number,
  levels: readonly Level[],
): Map<string, KnownNow> {
  const known = new Map<string, KnownNow>();
  for (const track of tracks) {
    const sighting = picture?.nodes.get(track.node);
    const point = pointAt(track, now);
    if (sighting === undefined || point === null || !isMoving(sighting.state.role)) continue;
    const { state } = sighting;
    const { position, covariance } = point;
    const level = nearestLevel(levels, position[2]);
    const shown = state.position_m;
    const ellipse = covarianceAt(sighting, now);
    known.set(track.node, {
      node: track.node,
      position,
      covariance,
      level,
      level_p: level === null ? null : storeyProbability(levels, position[2], covariance[5]),
      off_m: shown == null ? null : Math.hypot(position[0] - shown[0], position[1] - shown[1]),
      outside:
        shown != null &&
        ellipse !== null &&
        isOutside(ellipse, position[0] - shown[0], position[1] - shown[1]),
      otherStorey:
        state.role === "responder" && level !== null && state.level != null && level !== state.level,
    });
  }
  return known;
}

/** "3.2 m off, outside the ellipse, on First floor": how what is known now differs from what was shown. */
export function knownWords(known: KnownNow, node: FrameNode, levels: readonly Level[]): string {
  const words = [known.off_m === null ? "not shown then" : `${metres(known.off_m)} off`];
  if (known.outside) words.push("outside the ellipse");
  const stood = { ...node, level: known.level, level_p: known.level_p };
  if (known.otherStorey || (known.level !== null && storeyUnsure(node)))
    words.push(storeyWords(stood, levels));
  return words.join(", ");
}

/** Whether a step leads out of the 95 % ellipse of a covariance. */
function isOutside(covariance: Covariance, east_m: number, north_m: number): boolean {
  const { major_m, minor_m, angle_rad } = ellipseOf(covariance);
  const along = east_m * Math.cos(angle_rad) + north_m * Math.sin(angle_rad);
  const across = north_m * Math.cos(angle_rad) - east_m * Math.sin(angle_rad);
  // Of one who stands for sure, the numbers' last digits are no way.
  const least_m = K95 * 1e-3;
  return Math.hypot(along / Math.max(major_m, least_m), across / Math.max(minor_m, least_m)) > 1;
}

/** A storey reaches halfway to its neighbours, as for the server. */
function nearestLevel(levels: readonly Level[], up_m: number): number | null {
  let best: Level | null = null;
  for (const level of levels) {
    if (best === null || Math.abs(level.up_m - up_m) < Math.abs(best.up_m - up_m)) best = level;
  }
  return best?.level ?? null;
}
