/** Who has fallen silent together: what one gateway hears comes from many, and they are not lost one by one. */

import { ageS, isMoving, type StalenessLimits, statusAt } from "../fixes/staleness";
import type { Picture } from "../picture";
import type { FrameNode } from "../types";
import { ageWords, nameInText } from "../words";
import { whyUnplaced } from "./unplaced";

export interface Silence {
  /** The crew of whom nobody is heard; null: nobody of any. */
  readonly crew: string | null;
  /** Since the last word of one of them (s). */
  readonly age_s: number;
}

/** Fewer than two are not silent together. */
const TOGETHER = 2;

/** All, or the crews, of whom nobody is heard now. Whoever is heard and not followed is not silent. */
export function silences(picture: Picture | null, now: number, limits: StalenessLimits): Silence[] {
  // What is heard by a clock that is behind is not as old as it seems.
  if (picture === null || picture.clocks.length > 0) return [];
  const why = whyUnplaced(picture);
  const moving = [...picture.nodes.values()]
    .map(({ state }) => state)
    .filter(({ role, status }) => isMoving(role) && status !== "retired");
  const silent = (them: readonly FrameNode[]) =>
    them.length >= TOGETHER &&
    them.every((node) => statusAt(node, now, limits) !== "live" && !why.has(node.node));
  const age_s = (them: readonly FrameNode[]) => Math.min(...them.map((node) => ageS(node, now)));
  if (silent(moving)) return [{ crew: null, age_s: age_s(moving) }];
  const crews = [...new Set(moving.flatMap(({ crew }) => crew || []))].sort();
  return crews
    .map((crew) => [crew, moving.filter((node) => node.crew === crew)] as const)
    .filter(([, them]) => silent(them))
    .map(([crew, them]) => ({ crew, age_s: age_s(them) }));
}

export function silenceInWords({ crew }: Silence): string {
  return crew === null ? "Nobody has been heard" : `Nobody of ${nameInText(crew)} has been heard`;
}

/** For how long, and where to look: one who falls silent may be in trouble, and all at once hardly ever are. */
export function sinceInWords({ crew, age_s }: Silence): string {
  return `for ${ageWords(age_s)}: look to ${crew === null ? "the gateways and their links" : "their gateway and its link"}.`;
}
