/** A crew's mark: an Okabe–Ito colour, never alone, always with its letters. */
import type { FrameNode } from "./types";
import { nameOf } from "./words";

export interface CrewMark {
  readonly letters: string;
  readonly colour: string;
  /** Colour of letters on `colour`, at least 4.5 : 1. */
  readonly ink: string;
}

const DARK = "#101418";
/** Okabe and Ito (2008) without vermillion, which is too near to the red of alarms, and black. */
const COLOURS: readonly { colour: string; ink: string }[] = [
  { colour: "#56b4e9", ink: DARK },
  { colour: "#e69f00", ink: DARK },
  { colour: "#009e73", ink: DARK },
  { colour: "#f0e442", ink: DARK },
  { colour: "#cc79a7", ink: DARK },
  { colour: "#0072b2", ink: "#ffffff" },
];
const NO_CREW: Omit<CrewMark, "letters"> = { colour: "#aab2ba", ink: DARK };
const UAV: CrewMark = { letters: "UAV", colour: "#aab2ba", ink: DARK };

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
    marks.set(crew, {
      letters: crewLetters(crew),
      colour: colours.colour,
      ink: colours.ink,
    });
  }
  return marks;
}

/** Of whom no crew is known the mark carries the end of his name, by which he differs from the others. */
export function markOf(node: FrameNode, marks: ReadonlyMap<string, CrewMark>): CrewMark {
  if (node.role === "uav") return UAV;
  const known = node.crew ? marks.get(node.crew) : undefined;
  return known ?? { ...NO_CREW, letters: lettersOf(nameOf(node)).slice(-ROOM) || "?" };
}
