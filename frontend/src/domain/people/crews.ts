/** A crew's mark: an Okabe–Ito colour, never alone, always with its letters. */
import type { FrameNode } from "../types";
import { nameOf } from "../words";

export interface CrewMark {
  readonly letters: string;
  readonly colour: string;
  /** Colour of letters on `colour`, at least 4.5 : 1. */
  readonly ink: string;
  /** The same hue as a thin line, at least 3 : 1 against what lies under it by day, and by dusk and night. */
  readonly line: { readonly light: string; readonly dark: string };
}

const DARK = "#101418";
/** Okabe and Ito (2008) without vermillion, which is too near to the red of alarms, and black. */
const COLOURS: readonly Omit<CrewMark, "letters">[] = [
  { colour: "#56b4e9", ink: DARK, line: { light: "#448eb8", dark: "#56b4e9" } },
  { colour: "#e69f00", ink: DARK, line: { light: "#b37c00", dark: "#e69f00" } },
  { colour: "#009e73", ink: DARK, line: { light: "#009970", dark: "#05a076" } },
  { colour: "#f0e442", ink: DARK, line: { light: "#908928", dark: "#f0e442" } },
  { colour: "#cc79a7", ink: DARK, line: { light: "#ba6e98", dark: "#cc79a7" } },
  { colour: "#0072b2", ink: "#ffffff", line: { light: "#0072b2", dark: "#3d94c4" } },
];
const NO_CREW: Omit<CrewMark, "letters"> = {
  colour: "#aab2ba",
  ink: DARK,
  line: { light: "#81878d", dark: "#aab2ba" },
};
const UAV: CrewMark = { ...NO_CREW, letters: "UAV" };

/** Letters and digits that a mark has room for. */
const ROOM = 3;

function lettersOf(name: string): string {
  return name.replace(/[^\p{L}\p{N}]/gu, "");
}

/**
 * "E7" of "Engine 7", "C10" of "Crew 10", "AN" of "Attack North", "Res" of "Rescue": the number tells crews of one
 * kind apart, and there are more crews than colours.
 */
function crewLetters(name: string): string {
  const all = lettersOf(name);
  if ([...all].length <= ROOM) return all || "?";
  const number = name.match(/\p{N}+/gu)?.at(-1) ?? "";
  const words = name.slice(0, number === "" ? undefined : name.lastIndexOf(number)).match(/\p{L}+/gu) ?? [];
  if (number === "" && words.length === 1) return [...all].slice(0, ROOM).join("");
  const initials = words.map((word) => [...word][0]).join("");
  return initials.slice(0, Math.max(0, ROOM - number.length)) + number.slice(-ROOM);
}

/** A mark for each crew; colours go round in the order of the names, so all screens agree. */
export function crewMarks(nodes: Iterable<FrameNode>): Map<string, CrewMark> {
  const names = new Set<string>();
  for (const node of nodes) if (node.crew) names.add(node.crew);
  const marks = new Map<string, CrewMark>();
  for (const crew of [...names].sort((a, b) => a.localeCompare(b))) {
    const colours = COLOURS[marks.size % COLOURS.length] ?? NO_CREW;
    marks.set(crew, { ...colours, letters: crewLetters(crew) });
  }
  return marks;
}

/** Of whom no crew is known the mark carries the end of his name, by which he differs from the others. */
export function markOf(node: FrameNode, marks: ReadonlyMap<string, CrewMark>): CrewMark {
  if (node.role === "uav") return UAV;
  const known = node.crew ? marks.get(node.crew) : undefined;
  return known ?? { ...NO_CREW, letters: lettersOf(nameOf(node)).slice(-ROOM) || "?" };
}
