/** The map in words, for those who do not see it. */
import type { BoardCounts } from "./accountability";
import type { LevelChoice } from "./levels";
import type { Level } from "./types";
import { levelWords, plural } from "./words";

export function mapInWords(
  counts: BoardCounts,
  alarms: number,
  breadcrumbs: number,
  choice: LevelChoice,
  levels: readonly Level[],
): string {
  const where = choice === "all" ? "all storeys" : levelWords(choice, levels);
  return [
    `Map of ${where}: ${plural(counts.responders, "responder")}`,
    `${counts.live} live, ${counts.stale} stale, ${counts.lost} lost`,
    plural(breadcrumbs, "breadcrumb"),
    alarms === 0 ? "no alarm" : plural(alarms, "alarm"),
  ].join(", ");
}
