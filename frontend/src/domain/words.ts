/** What the screen says, in the words of the field. */
import type { FrameAlarm, FrameNode, Level, Status } from "./types";

const STATUS_WORDS: Record<Status, string> = {
  live: "Live",
  stale: "Stale",
  lost: "Lost",
  // Who has left, and also whose unit is lost or burned: that he is out of the building must not be read from it.
  retired: "Not tracked",
};

const ALARM_WORDS: Record<FrameAlarm["alarm"], string> = {
  mayday: "MAYDAY",
  pass: "PASS",
  evacuate: "EVACUATE",
  help: "HELP",
};

/** `ofThen`: the status is one of the past, or at the end of the incident. */
export function statusWord(status: Status, ofThen = false): string {
  return ofThen && status === "live" ? "Was live" : STATUS_WORDS[status];
}

export function alarmWord(alarm: FrameAlarm["alarm"]): string {
  return ALARM_WORDS[alarm];
}

/** Who has not been heard for so long was never heard by this clock: the unit's own is wrong (days). */
const MOST_DAYS = 999;

/** An age in seconds as "12 s", "3 min 05 s", "2 h 04 min", "5 days". */
export function ageWords(age_s: number): string {
  const whole = Math.max(0, Math.floor(age_s));
  if (whole < 60) return `${whole} s`;
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${two(whole % 60)} s`;
  if (whole < 360_000) return `${Math.floor(whole / 3600)} h ${two(Math.floor((whole % 3600) / 60))} min`;
  return `${days(whole)} days`;
}

/** An age beside a mark on the map, where there is room for one unit only: "12 s", "3 min", "2 h". */
export function shortAge(age_s: number): string {
  const whole = Math.max(0, Math.floor(age_s));
  if (whole < 120) return `${whole} s`;
  if (whole < 7200) return `${Math.floor(whole / 60)} min`;
  return whole < 360_000 ? `${Math.floor(whole / 3600)} h` : `${days(whole)} d`;
}

function days(whole_s: number): string {
  const count = Math.floor(whole_s / 86_400);
  return count > MOST_DAYS ? `> ${MOST_DAYS}` : String(count);
}

export function agoWords(age_s: number): string {
  return `${ageWords(age_s)} ago`;
}

/** The callsign, and the node's own name where it has none. */
export function nameOf(node: Pick<FrameNode, "node" | "callsign">): string {
  return node.callsign || node.node;
}

/** Hebrew, Arabic and their neighbours, which are written from the right. */
const FROM_THE_RIGHT = /[\u0590-\u08ff\ufb1d-\ufdff\ufe70-\ufefc]/;
/** So many letters of a name have room beside a mark. */
const BESIDE_MARK = 22;

/** So many letters at its beginning, and at its end, tell a long name from others. */
const TELLING = (BESIDE_MARK - 2) / 2;

/**
 * A name in one text with other words: one from the right draws no numbers after it to its other side (Unicode
 * Annex 9, isolates). A long one gives way in its middle: its beginning and its end tell it from others.
 */
export function nameInText(name: string): string {
  const letters = [...name];
  const fits =
    letters.length <= BESIDE_MARK
      ? name
      : `${letters.slice(0, TELLING).join("")}…${letters.slice(-TELLING).join("")}`;
  return FROM_THE_RIGHT.test(fits) ? `\u2068${fits}\u2069` : fits;
}

/** A long name as what gives way where there is no room, and its end, which does not; null for a short one, and for
 * one from the right, whose parts would change sides. */
export function nameInParts(name: string): readonly [string, string] | null {
  const letters = [...name];
  if (letters.length <= BESIDE_MARK || FROM_THE_RIGHT.test(name)) return null;
  return [letters.slice(0, -TELLING).join(""), letters.slice(-TELLING).join("")];
}

/** The spoken name of a level: the incident's own, else the bare number. */
export function levelName(level: number | null | undefined, levels: readonly Level[]): string {
  if (level == null) return "storey not known";
  return levels.find((known) => known.level === level)?.name ?? String(level);
}

/** A level as the list says it: "Level 1" or, for names that say it themselves, the name alone. */
export function levelWords(level: number | null | undefined, levels: readonly Level[]): string {
  const name = levelName(level, levels);
  return level == null || name.length > 3 ? name : `Level ${name}`;
}

/** A probability as "93 %"; never 100 % or 0 % where it is not certain. */
export function percent(p: number): string {
  const rounded = Math.round(p * 100);
  if (rounded >= 100 && p < 1) return "> 99 %";
  if (rounded <= 0 && p > 0) return "< 1 %";
  return `${rounded} %`;
}

/** Metres with as many digits as matter: "0.8 m", "12.4 m", "130 m". */
export function metres(value_m: number): string {
  return `${Math.abs(value_m) >= 100 ? value_m.toFixed(0) : value_m.toFixed(1)} m`;
}

/** How far off a position may be: beyond 10 km its digits tell nothing. */
export function spread(value_m: number): string {
  return value_m > 10_000 ? "over 10 km" : metres(value_m);
}

/** The same beside a mark, in whole metres: digits that change each moment are not read. */
export function roughly(value_m: number): string {
  return value_m > 10_000 ? spread(value_m) : `${Math.max(1, Math.round(value_m))} m`;
}

/** A distance to one side or the other: "4.0 m S", in one piece where a line breaks. */
export function sideways(value_m: number, positive: string, negative: string): string {
  return `${metres(Math.abs(value_m))} ${value_m < 0 ? negative : positive}`.replaceAll(" ", "\u00a0");
}

/** A heading as a compass bearing, clockwise from north: "074°". */
export function compassBearing(heading_rad: number): string {
  const degrees = 90 - (heading_rad * 180) / Math.PI;
  const wrapped = Math.round(((degrees % 360) + 360) % 360) % 360;
  return `${String(wrapped).padStart(3, "0")}°`;
}

/** How old a report is: a unit may be heard while what measures air or battery has long been silent. */
export interface Told {
  readonly status: Status;
  /** Since it was told (s); null where that is not known. */
  readonly age_s: number | null;
  /** From this age on it is not taken for what is so now (s). */
  readonly oldAfter_s: number;
}

export function isOld({ age_s, oldAfter_s }: Told): boolean {
  return age_s !== null && age_s > oldAfter_s;
}

/** What somebody reported, and that it was so then where nothing has been heard since, of him or of that. */
export function asOf(told: Told, said: string): string {
  if (isOld(told)) return `was ${said}, ${shortAge(told.age_s ?? 0)} ago`;
  return told.status === "live" ? said : `was ${said}`;
}

/** A charge of 0 to 1 as "80 %". */
export function batteryWords(battery: number | null | undefined, told: Told): string {
  return battery == null ? "not reported" : asOf(told, `${Math.round(battery * 100)} %`);
}

export function airWords(air_bar: number | null | undefined, told: Told): string {
  return air_bar == null ? "not reported" : asOf(told, `${Math.round(air_bar)} bar`);
}

function two(value: number): string {
  return String(value).padStart(2, "0");
}

/** How many of what: `1 alarm`, `2 alarms`. */
export function plural(count: number, word: string): string {
  return `${count} ${word}${count === 1 ? "" : "s"}`;
}
