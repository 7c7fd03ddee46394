/** The map in words, for those who do not see it. */

import type { LevelChoice } from "../fixes/levels";
import type { BoardCounts } from "../people/accountability";
import { liveWords, type Presence } from "../people/presence";
import type { Level } from "../types";
import { levelWords, plural } from "../words";

export function mapInWords(
  counts: BoardCounts,
  alarms: number,
  breadcrumbs: number,
  choice: LevelChoice,
  levels: readonly Level[],
  presence: Presence,
  lowOnAir = 0,
): string {
  const where = choice === "all" ? "all storeys" : levelWords(choice, levels);
  return [
    `Map of ${where}: ${plural(counts.responders, "responder")}`,
    `${liveWords(counts.live, presence)}, ${counts.stale} stale, ${counts.lost} lost`,
    plural(breadcrumbs, "breadcrumb"),
    alarms === 0 ? "no alarm" : plural(alarms, "alarm"),
    ...(lowOnAir === 0 ? [] : [`${lowOnAir} low on air`]),
  ].join(", ");
}
