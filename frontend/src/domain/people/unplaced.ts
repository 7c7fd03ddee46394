/** Who is heard and not followed on the map, and why: nobody looks for a dot that cannot come. */

import { isMoving } from "../fixes/staleness";
import type { Picture } from "../picture";
import type { FrameMessage, FrameNode } from "../types";
import { nameInText, nameOf } from "../words";

export interface Unplaced {
  readonly names: readonly string[];
  readonly why: string;
  /** By which gateway, where that is known. */
  readonly gateway: string | null;
  /** When one of them was heard last (s ago); null where that is not known. */
  readonly heard_s: number | null;
}

/** What the estimator says of readings none of which places anybody: they come too late, or the incident has no
 * origin from which their latitudes count. */
const NOT_PLACING: ReadonlySet<string> = new Set(["too_late", "no_origin"]);

/** As short as a name beside a mark: it does not give way in its middle. */
const NAMELESS = "a unit without a name";

/** One entry for each reason, with all whom it keeps from the map. */
export function unplaced(picture: Picture | null, now: number): Unplaced[] {
  const found = new Map<string, Unplaced>();
  for (const { name, callsign, gateway, t, text } of picture?.setAside ?? []) {
    const shown = callsign || name;
    put(found, shown === "" ? NAMELESS : shown, text, gateway, Math.max(0, now - t));
  }
  for (const { node, text } of notPlacing(picture)) {
    const known = picture?.nodes.get(node)?.state;
    put(found, known ? nameOf(known) : node, text, null, null);
  }
  return [...found.values()];
}

/** Why a node is not followed, of those that have a line on the board. */
export function whyUnplaced(picture: Picture | null): Map<string, string> {
  const why = new Map(notPlacing(picture).map(({ node, text }): [string, string] => [node, text]));
  for (const { name, text } of picture?.setAside ?? []) why.set(name, text);
  return why;
}

/** Said aloud once it changes; ages, which count up, would be said each second. */
export function unplacedInWords(all: readonly Unplaced[]): string {
  return all
    .map(({ names, why }) => `Heard, not followed: ${names.map(nameInText).join(", ")}: ${why}.`)
    .join(" ");
}

/** What is told of readings that place nobody, of whom they keep from the map. */
function notPlacing(picture: Picture | null): { node: string; text: string }[] {
  return (picture?.notices ?? []).flatMap(({ code, node, text }: FrameMessage["notices"][number]) => {
    if (!NOT_PLACING.has(code) || node === null) return [];
    const known = picture?.nodes.get(node)?.state;
    return known === undefined || isNowhere(known) ? [{ node, text }] : [];
  });
}

function isNowhere({ role, status, position_m }: FrameNode): boolean {
  return isMoving(role) && status !== "retired" && !position_m;
}

function put(
  found: Map<string, Unplaced>,
  name: string,
  why: string,
  gateway: string | null,
  heard_s: number | null,
): void {
  const key = `${gateway} ${why}`;
  const known = found.get(key);
  const names = [...(known?.names ?? []), name];
  const least_s = known?.heard_s == null || heard_s === null ? heard_s : Math.min(known.heard_s, heard_s);
  found.set(key, { names, why, gateway, heard_s: least_s });
}
