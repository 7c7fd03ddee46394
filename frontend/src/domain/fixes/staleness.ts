/** Age of a fix, and what it makes of the node: live, stale, lost. */
import type { Sighting } from "../picture";
import type { Covariance, FrameNode, Incident, Role, Status } from "../types";
import type { Told } from "../words";

/** Ages beyond which a fix is stale and lost (s), for what moves and what stands. */
export interface StalenessLimits {
  readonly staleAfterS: number;
  readonly lostAfterS: number;
  readonly staticStaleAfterS: number;
  readonly staticLostAfterS: number;
}

export const DEFAULT_LIMITS: StalenessLimits = {
  staleAfterS: 10,
  lostAfterS: 60,
  staticStaleAfterS: 60,
  staticLostAfterS: 300,
};

/** How fast an unseen responder may leave its last fix: standard deviation per second of age (m/s). */
const HORIZONTAL_GROWTH_MPS = 0.5;
const VERTICAL_GROWTH_MPS = 0.1;
const GROWS_AFTER_S = 1;

const SEVERITY: Record<Status, number> = { live: 0, stale: 1, lost: 2, retired: 3 };

/** The limits that the incident's settings name, and the defaults for those they do not. */
export function limitsOf(incident: Incident | null): StalenessLimits {
  const settings: Record<string, unknown> = incident?.settings ?? {};
  const seconds = (name: string, otherwise: number) => {
    const value = settings[name];
    return typeof value === "number" && value > 0 ? value : otherwise;
  };
  return {
    staleAfterS: seconds("stale_after_s", DEFAULT_LIMITS.staleAfterS),
    lostAfterS: seconds("lost_after_s", DEFAULT_LIMITS.lostAfterS),
    staticStaleAfterS: seconds("static_stale_after_s", DEFAULT_LIMITS.staticStaleAfterS),
    staticLostAfterS: seconds("static_lost_after_s", DEFAULT_LIMITS.staticLostAfterS),
  };
}

/** The limits while the server cannot be heard: nobody who moves is live, however new the last fix is. */
export function whileUnheard(limits: StalenessLimits): StalenessLimits {
  return { ...limits, staleAfterS: -1 };
}

/** The roles of what moves. */
export const MOVING: Role[] = ["responder", "uav"];

export function isMoving(role: Role): boolean {
  return MOVING.includes(role);
}

/** Seconds since the newest fused reading; never negative. */
export function ageS(node: FrameNode, now: number): number {
  return Math.max(0, now - node.t);
}

/**
 * Status at `now`: the server's, or a worse one where the fix has aged since. So dots go stale
 * and lost on the screen even while no word comes from the server.
 */
export function statusAt(node: FrameNode, now: number, limits: StalenessLimits): Status {
  if (node.status === "retired" || node.role === "base") return node.status;
  const age = ageS(node, now);
  const moving = isMoving(node.role);
  const lostAfter = moving ? limits.lostAfterS : limits.staticLostAfterS;
  const staleAfter = moving ? limits.staleAfterS : limits.staticStaleAfterS;
  const byAge: Status = age > lostAfter ? "lost" : age > staleAfter ? "stale" : "live";
  return SEVERITY[byAge] > SEVERITY[node.status] ? byAge : node.status;
}

/** How old what a node told at `toldT` (Unix s; nothing: not known when) is at `now`. */
export function toldAt(
  toldT: number | null | undefined,
  status: Status,
  now: number,
  limits: StalenessLimits,
): Told {
  const age_s = toldT == null ? null : Math.max(0, now - toldT);
  return { status, age_s, oldAfter_s: limits.lostAfterS };
}

/** Covariance at `now` (m²): the server's, grown by what a moving node may have walked since. */
export function covarianceAt(
  { state, presentedT }: Pick<Sighting, "state" | "presentedT">,
  now: number,
): Covariance | null {
  const covariance = state.covariance_m2 ?? null;
  if (covariance === null || !isMoving(state.role) || state.status === "retired") return covariance;
  const grownS2 = growthS2(ageS(state, now)) - growthS2(ageS(state, presentedT));
  if (grownS2 <= 0) return covariance;
  const [ee, en, eu, nn, nu, uu] = covariance;
  const horizontal = HORIZONTAL_GROWTH_MPS ** 2 * grownS2;
  const vertical = VERTICAL_GROWTH_MPS ** 2 * grownS2;
  return [ee + horizontal, en, eu, nn + horizontal, nu, uu + vertical];
}

function growthS2(age: number): number {
  return age > GROWS_AFTER_S ? age * age : 0;
}
