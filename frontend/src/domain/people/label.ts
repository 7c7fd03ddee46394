/** What stands beside a responder on the map: who, in which alarm, how old the fix, where it is not plain. */

import { type LevelChoice, levelOf, storeyBesideMark, storeyUnsure } from "../fixes/levels";
import { ageS, type StalenessLimits, statusAt } from "../fixes/staleness";
import type { FrameAlarm, FrameNode, Level } from "../types";
import { alarmWord, nameInText, nameOf, roughly, shortAge, statusWord } from "../words";
import { isLowOnAir } from "./air";

export interface Labelled {
  /** Incident time (Unix s). */
  readonly now: number;
  readonly limits: StalenessLimits;
  readonly levels: readonly Level[];
  /** The storey that the map shows. */
  readonly level: LevelChoice;
  readonly alarms: ReadonlyMap<string, FrameAlarm>;
  /** The map is a phone's: that a storey is not sure is said, not which one it may be. */
  readonly narrow: boolean;
}

export interface LabelWords {
  /** Its lines. */
  readonly whole: readonly string[];
  /** Its one line, where there is no room: without the storey, unless that is not sure or he calls. */
  readonly short: string;
  /** Where there is no room for that either: that the storey is not sure, not which one it may be. */
  readonly brief: string;
}

/** `error_m`: how far off the position may be, where that is not seen on the map. */
export function labelWords(
  node: FrameNode,
  { now, limits, levels, level, alarms, narrow }: Labelled,
  error_m: number | null = null,
): LabelWords {
  const status = statusAt(node, now, limits);
  const alarm = alarms.get(node.node);
  const age = shortAge(ageS(node, now));
  const callsign = nameInText(nameOf(node));
  const called = alarm ? `${callsign} ${alarmWord(alarm.alarm)}` : callsign;
  const name = isLowOnAir(node) ? `${called} LOW AIR` : called;
  const heard = status === "live" ? age : `${statusWord(status).toUpperCase()} ${age}`;
  const old = error_m === null ? heard : `${heard} · ± ${roughly(error_m)}`;
  const said = saysStorey(node, level, levels);
  const storey = ` · ${storeyBesideMark(node, levels)}`;
  const line = `${name} · ${old}`;
  const unsure = said && storeyUnsure(node);
  const brief = unsure ? `${line} · storey?` : line;
  // Who goes to help takes the stairs first.
  const needed = unsure || (said && alarm !== undefined);
  const short = needed && !narrow ? line + storey : brief;
  return { whole: [name, said ? old + storey : old], short, brief };
}

/** Not of who flies, nor of who stands, for sure, on the storey that is shown. */
function saysStorey(node: FrameNode, shown: LevelChoice, levels: readonly Level[]): boolean {
  const level = levelOf(node, levels);
  return node.role !== "uav" && level !== null && (level !== shown || storeyUnsure(node));
}
