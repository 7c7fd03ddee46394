/** What the incident was set to, and when: of a moment of the past its storeys and limits are those of then. */

import type { Incident, Stretch } from "../types";
import type { Mark } from "./timeline";

const WORDS: Record<string, string> = {
  tracker: "tracker",
  lag_s: "lag",
  stale_after_s: "stale after",
  lost_after_s: "lost after",
  static_stale_after_s: "breadcrumbs stale after",
  static_lost_after_s: "breadcrumbs lost after",
  low_air_bar: "low air",
};

/** The incident as it was set when `t` (Unix s) was shown, of which the newest log entry was `seq`. */
export function toldAt(incident: Incident, t: number, seq: number): Incident {
  const began = incident.stretches.filter(({ since, after_seq }) =>
    incident.clock === "live" ? since <= t : after_seq < seq,
  );
  const told = began.at(-1) ?? incident.stretches[0];
  if (told === undefined) return incident;
  return { ...incident, origin: told.origin, levels: told.levels, settings: told.settings };
}

/**
 * Marks of what was set under way.
 *
 * @param incident whose
 * @param whenTold the newest epoch (Unix s) that was told up to a log entry, as far as it is known: where readings
 *   are the clock, that was now when something was set
 */
export function setMarks(
  { clock, stretches }: Incident,
  whenTold: ReadonlyMap<number, number>,
): readonly Mark[] {
  return stretches.flatMap((stretch, index): Mark[] => {
    const before = stretches[index - 1];
    const t = clock === "live" ? stretch.since : whenTold.get(stretch.after_seq);
    if (before === undefined || t === undefined) return [];
    return [{ t, kind: "set", text: `Set: ${changed(before, stretch).join(", ")}` }];
  });
}

function changed(before: Stretch, after: Stretch): readonly string[] {
  const was: Record<string, unknown> = before.settings;
  const is: Record<string, unknown> = after.settings;
  return [
    ...(same(before.origin, after.origin) ? [] : ["origin"]),
    ...(same(before.levels, after.levels) ? [] : ["storeys"]),
    ...Object.keys(is)
      .filter((name) => was[name] !== is[name])
      .map((name) => `${WORDS[name] ?? name} ${is[name]}`),
  ];
}

function same(one: unknown, other: unknown): boolean {
  return JSON.stringify(one) === JSON.stringify(other);
}
