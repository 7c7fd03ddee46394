/** Storeys: on which one a node is, which there are, how many responders each holds. */
import type { Picture } from "../picture";
import type { FrameNode, Level } from "../types";
import { levelWords, nameInText, percent } from "../words";

/** The storey shown: one, or all of them. */
export type LevelChoice = number | "all";

/** Below this probability the storey is said with it. */
export const SURE_P = 0.9;

/** A node this far above a storey's floor still belongs to it rather than to the next (m). */
const BELOW_FLOOR_M = 0.8;

/** The node's level: what the estimator says, else the storey whose floor is next below it. */
export function levelOf(node: FrameNode, levels: readonly Level[]): number | null {
  if (node.level != null) return node.level;
  const up_m = node.position_m?.[2];
  if (up_m === undefined || levels.length === 0) return null;
  let best: Level | null = null;
  for (const level of levels) {
    if (level.up_m <= up_m + BELOW_FLOOR_M && (best === null || level.up_m > best.up_m)) best = level;
  }
  return (best ?? levels.reduce((low, level) => (level.up_m < low.up_m ? level : low))).level;
}

/** Whether the storey is one among several that it may be. */
export function storeyUnsure(node: FrameNode): boolean {
  return node.level_p != null && node.level_p < SURE_P;
}

/** The node's storey as it is said: "First floor", and "First floor, 64 %" where it is not sure. */
export function storeyWords(node: FrameNode, levels: readonly Level[]): string {
  return withProbability(levelWords(levelOf(node, levels), levels), node);
}

/** The same beside a mark: a long name gives way in its middle, not the probability behind it. */
export function storeyBesideMark(node: FrameNode, levels: readonly Level[]): string {
  return withProbability(nameInText(levelWords(levelOf(node, levels), levels)), node);
}

function withProbability(words: string, node: FrameNode): string {
  return node.level_p != null && storeyUnsure(node) ? `${words}, ${percent(node.level_p)}` : words;
}

export interface LevelButton {
  readonly level: LevelChoice;
  readonly name: string;
  readonly responders: number;
  readonly alarms: number;
}

/** A button per storey, the highest first as a building stands, and one for all of them on top. */
export function levelButtons(
  picture: Picture | null,
  levels: readonly Level[],
  inAlarm: ReadonlySet<string>,
): LevelButton[] {
  const names = new Map(levels.map((level) => [level.level, level.name]));
  const responders = new Map<number, number>();
  const alarms = new Map<number, number>();
  let all = 0;
  for (const { state } of picture?.nodes.values() ?? []) {
    if (state.role !== "responder" || state.status === "retired") continue;
    all += 1;
    const level = levelOf(state, levels);
    if (level === null) continue;
    if (!names.has(level)) names.set(level, String(level));
    responders.set(level, (responders.get(level) ?? 0) + 1);
    if (inAlarm.has(state.node)) alarms.set(level, (alarms.get(level) ?? 0) + 1);
  }
  const storeys = [...names.keys()]
    .sort((a, b) => b - a)
    .map((level) => ({
      level,
      name: names.get(level) ?? String(level),
      responders: responders.get(level) ?? 0,
      alarms: alarms.get(level) ?? 0,
    }));
  return [{ level: "all", name: "All", responders: all, alarms: inAlarm.size }, ...storeys];
}

/** A button and the gap to the next, and what of the map's height is not theirs (CSS pixels). */
const BUTTON_PX = 50;
const NOT_THEIRS_PX = 70;
/** More columns than these would cover the people on the map. */
export const STOREY_COLUMNS = 2;
/** On a phone they lie in a row over the head of the map. */
const ON_A_PHONE = 6;
const PHONE_PX = 520;

/** How many storey buttons have room on a map of that size (CSS pixels). */
export function storeysThatFit({ width, height }: { width: number; height: number }): number {
  if (width <= PHONE_PX) return ON_A_PHONE;
  return STOREY_COLUMNS * Math.max(1, Math.floor((height - NOT_THEIRS_PX) / BUTTON_PX));
}

/**
 * The buttons for which there is room: of a tower's storeys those that matter. Whoever chooses one that is `kept`
 * finds it where it was.
 */
export function withoutEmpty(
  buttons: readonly LevelButton[],
  room: number,
  chosen: LevelChoice,
  kept: ReadonlySet<LevelChoice>,
): readonly LevelButton[] {
  if (buttons.length <= room) return buttons;
  return buttons.filter(
    ({ level, responders, alarms }) =>
      level === "all" || level === chosen || responders > 0 || alarms > 0 || kept.has(level),
  );
}

/** The storey above (+1) or below (-1) the chosen one; "all" lies above the highest. */
export function neighbourLevel(
  choice: LevelChoice,
  step: 1 | -1,
  buttons: readonly LevelButton[],
): LevelChoice {
  const index = buttons.findIndex((button) => button.level === choice);
  const next = buttons[Math.min(buttons.length - 1, Math.max(0, index - step))];
  return next?.level ?? "all";
}
