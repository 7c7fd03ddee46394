/** Where labels go: beside their marks while there is room, else shortened, else farther off with a line to the mark. */
import type { Box } from "./layer";

export interface Size {
  readonly width: number;
  readonly height: number;
}

/** A mark that wants a label. */
export interface Wanted {
  readonly node: string;
  /** Its place, and how far from there its label stays (CSS pixels). */
  readonly x: number;
  readonly y: number;
  readonly away: number;
  readonly whole: Size;
  /** Where there is no room for the whole. */
  readonly short: Size;
  /** It is shown, even if it covers others. */
  readonly always: boolean;
  /** How much it matters among the others. */
  readonly rank: number;
}

/** Whole or short beside the mark, or short and led to it by a line. */
export type Kind = "whole" | "short" | "led";

/** The place of a label, and which of the places of its kind it is. */
export interface Spot {
  readonly kind: Kind;
  readonly index: number;
  readonly box: Box;
  /** What the line to the mark takes up; nothing beside it. */
  readonly line: readonly Box[];
}

/** Where more labels than these matter as much as one, it has no line, as nobody could follow them all. */
export const MOST_LED = 30;
/** Rings of places for labels with a line: how far beyond the mark (CSS pixels), and how many places each has. */
const RINGS_PX = [26, 52, 78];
/** Who is not heard is looked for in the thick of a crowd as well: how much farther a label may go. */
const FAR_RINGS_PX = [...RINGS_PX, 117, 156, 195];
const ON_RING = 12;
/** A line is held clear of labels in squares of this size. */
const LINE_PX = 8;
const CELL_PX = 64;

/**
 * Find a place for each label for which there is one.
 *
 * A label keeps its place among those of its kind while that is free: one that jumps about is not read. One that
 * looks for another place takes the first that hides nothing at all, where there is one.
 *
 * @param wanted those that matter most first.
 * @param marks what no label may cover.
 * @param covered what lies over the map: no label goes there.
 * @param map its size.
 * @param before the places in the picture before this one.
 * @param shunned what a label had better not cover either.
 */
export function labelPlaces(
  wanted: readonly Wanted[],
  marks: readonly Box[],
  covered: readonly Box[],
  map: Size,
  before: ReadonlyMap<string, Spot>,
  shunned: readonly Box[] = [],
): Map<string, Spot> {
  const found = new Map<string, Spot>();
  const [everything, over] = [new Occupied([...marks, ...covered]), new Occupied(covered)];
  const written = new Occupied(covered);
  const better = new Occupied(shunned);
  const free = (places: readonly Spot[], occupied: Occupied) =>
    places.find(({ box }) => inside(box, map) && occupied.leaves(box));
  const clear = ({ line }: Spot) => line.every((part) => written.leaves(part));
  const asMuch = (rank: number) => wanted.reduce((sum, other) => sum + Number(other.rank >= rank), 0);
  const led = new Map(
    [...new Set(wanted.map(({ rank }) => rank))].map((rank) => [rank, asMuch(rank) <= MOST_LED]),
  );
  for (const label of wanted) {
    const last = before.get(label.node);
    const pick = (places: readonly Spot[]) => {
      const room = places.filter(({ box }) => inside(box, map) && everything.leaves(box));
      const kept = room.find(({ kind, index }) => kind === last?.kind && index === last.index);
      return kept ?? room.find(({ box }) => better.leaves(box)) ?? room[0];
    };
    const whole = beside("whole", label);
    let spot = pick(whole) ?? pick(beside("short", label));
    if (spot === undefined && (label.always || led.get(label.rank))) {
      const far = farOff(label);
      spot = pick(far.filter(clear)) ?? pick(far);
    }
    if (label.always) spot ??= free(whole, written) ?? free(whole, over) ?? whole[0];
    if (spot === undefined) continue;
    for (const box of [spot.box, ...spot.line]) {
      everything.add(box);
      written.add(box);
    }
    found.set(label.node, spot);
  }
  return found;
}

/** At the right, left, below or above, then at the corners. */
function beside(kind: "whole" | "short", { x, y, away, [kind]: { width, height } }: Wanted): Spot[] {
  const [right, left, below, above] = [x + away, x - away - width, y + away / 2, y - away / 2 - height];
  const corners: [number, number][] = [
    [right, y - height / 2],
    [left, y - height / 2],
    [x - width / 2, y + away],
    [x - width / 2, y - away - height],
    [right, below],
    [right, above],
    [left, below],
    [left, above],
  ];
  return corners.map(([x, y], index) => ({ kind, index, box: { x, y, width, height }, line: [] }));
}

/** All round, the nearer ring first. */
function farOff({ x, y, away, rank, short: { width, height } }: Wanted): Spot[] {
  return (rank > 0 ? FAR_RINGS_PX : RINGS_PX).flatMap((beyond, ring) =>
    Array.from({ length: ON_RING }, (_, step): Spot => {
      const turn = (2 * Math.PI * step) / ON_RING;
      const box = {
        x: x + (away + beyond + width / 2) * Math.cos(turn) - width / 2,
        y: y + (away + beyond + height / 2) * Math.sin(turn) - height / 2,
        width,
        height,
      };
      return { kind: "led", index: ring * ON_RING + step, box, line: lineTo(box, x, y) };
    }),
  );
}

/** The nearest point of a box. */
export function nearest(box: Box, x: number, y: number): [number, number] {
  const between = (value: number, least: number, size: number) =>
    Math.min(Math.max(value, least), least + size);
  return [between(x, box.x, box.width), between(y, box.y, box.height)];
}

/** The line from a place to a box, in small squares. */
function lineTo(box: Box, x: number, y: number): Box[] {
  const [toX, toY] = nearest(box, x, y);
  const steps = Math.floor(Math.hypot(toX - x, toY - y) / LINE_PX);
  return Array.from({ length: steps }, (_, step) => {
    const share = (step + 0.5) / steps;
    const [middleX, middleY] = [x + (toX - x) * share, y + (toY - y) * share];
    return { x: middleX - LINE_PX / 2, y: middleY - LINE_PX / 2, width: LINE_PX, height: LINE_PX };
  });
}

function inside({ x, y, width, height }: Box, map: Size): boolean {
  return x >= 0 && y >= 0 && x + width <= map.width && y + height <= map.height;
}

/** Boxes by the cells of a grid that they touch, so that each is held against its neighbours alone. */
class Occupied {
  private readonly cells = new Map<number, Box[]>();

  constructor(boxes: readonly Box[]) {
    for (const box of boxes) this.add(box);
  }

  add(box: Box): void {
    for (const cell of cellsOf(box)) {
      const there = this.cells.get(cell);
      if (there) there.push(box);
      else this.cells.set(cell, [box]);
    }
  }

  /** Whether a box overlaps none of them. */
  leaves(box: Box): boolean {
    return !cellsOf(box).some((cell) => this.cells.get(cell)?.some((other) => overlap(box, other)));
  }
}

function cellsOf({ x, y, width, height }: Box): number[] {
  const cells: number[] = [];
  for (let row = Math.floor(y / CELL_PX); row * CELL_PX <= y + height; row += 1) {
    for (let column = Math.floor(x / CELL_PX); column * CELL_PX <= x + width; column += 1) {
      cells.push(row * 1024 + column);
    }
  }
  return cells;
}

/** Whether two boxes have a part in common. */
export function overlap(a: Box, b: Box): boolean {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}
