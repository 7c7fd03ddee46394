/** What stands beside a responder on the map: who, in which alarm, how old the fix, where it is not plain. */
import { type LevelChoice, levelOf, storeyUnsure, storeyWords } from "./levels";
import { ageS, type StalenessLimits, statusAt } from "./staleness";
import type { FrameAlarm, FrameNode, Level } from "./types";
import { alarmWord, nameOf, shortAge, statusWord } from "./words";

export interface Labelled {
  /** Incident time (Unix s). */
  readonly now: number;
  readonly limits: StalenessLimits;
  readonly levels: readonly Level[];
  /** The storey that the map shows. */
  readonly level: LevelChoice;
  readonly alarms: ReadonlyMap<string, FrameAlarm>;
}

export function labelLines(node: FrameNode, { now, limits, levels, level, alarms }: Labelled): string[] {
  const status = statusAt(node, now, limits);
  const alarm = alarms.get(node.node);
  const age = shortAge(ageS(node, now));
  const name = alarm ? `${nameOf(node)} ${alarmWord(alarm.alarm)}` : nameOf(node);
  const old = status === "live" ? age : `${statusWord(status).toUpperCase()} ${age}`;
  return [name, saysStorey(node, level, levels) ? `${old} · ${storeyWords(node, levels)}` : old];
}

/** Not of who flies, nor of who stands, for sure, on the storey that is shown. */
function saysStorey(node: FrameNode, shown: LevelChoice, levels: readonly Level[]): boolean {
  const level = levelOf(node, levels);
  return node.role !== "uav" && level !== null && (level !== shown || storeyUnsure(node));
}
