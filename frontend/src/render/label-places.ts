/** Where labels go: beside their marks while there is room, else shortened, else farther off with a line to the mark. */
import { distance, inside, middle, nearest, Occupied, wider } from "./boxes";
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
  /** Where else there would be no label. */
  readonly brief: Size;
  /** It is shown, even if it covers others. */
  readonly always: boolean;
  /** How much it matters among the others. */
  readonly rank: number;
}

/** How much is written. */
export type Text = "whole" | "short" | "brief";

/** The place of a label: beside the mark or led to it by a line, and which of these places it is. */
export interface Spot {
  readonly text: Text;
  readonly led: boolean;
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
/** A label is taken to be of the mark that is nearest: any other is to be so many times as far away as its own. */
const OTHERS_FARTHER = 1.5;
/** A line is held clear of labels in squares of this size. */
const LINE_PX = 8;

/**
 * Find a place for each label for which there is one.
 *
 * A label keeps its place among those of its kind while that is free: one that jumps about is not read. One that
 * looks for another place takes the first that hides nothing at all, where there is one. A place at which it would be
 * taken for another's, and a line over another's mark, come after all others.
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
  const [written, marked] = [new Occupied(covered), new Occupied(marks)];
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
    const wasThere = (spot: Spot) =>
      spot.text === last?.text && spot.led === last.led && spot.index === last.index;
    const pick = (places: readonly Spot[], suits: (spot: Spot) => boolean = () => true) => {
      const room = places.filter(
        (spot) => inside(spot.box, map) && everything.leaves(spot.box) && suits(spot),
      );
      return room.find(wasThere) ?? room.find(({ box }) => better.leaves(box)) ?? room[0];
    };
    const plain = (spot: Spot) => isPlain(label, spot, marked, wasThere(spot) ? 1 : OTHERS_FARTHER);
    const whole = beside("whole", label);
    let spot = pick(whole, plain);
    if (spot === undefined) {
      const [short, brief] = [beside("short", label), beside("brief", label)];
      const leads = label.always || led.get(label.rank);
      const [farShort, farBrief] = leads ? [farOff("short", label), farOff("brief", label)] : [[], []];
      const plainLine = (far: Spot) => clear(far) && plain(far);
      spot =
        pick(short, plain) ??
        pick(farShort, plainLine) ??
        pick(brief, plain) ??
        pick(farBrief, plainLine) ??
        pick(whole) ??
        pick(short) ??
        pick(farShort, clear) ??
        pick(farBrief, clear) ??
        pick(farShort) ??
        pick(brief) ??
        pick(farBrief);
      if (label.always) {
        const anywhere = [...whole, ...short, ...brief, ...farShort, ...farBrief];
        spot ??= free(anywhere, written) ?? free(anywhere, over) ?? whole[0];
      }
    }
    if (spot === undefined) continue;
    for (const box of [spot.box, ...spot.line]) {
      everything.add(box);
      written.add(box);
    }
    found.set(label.node, spot);
  }
  return found;
}

/**
 * Whether a label at that place is taken to be of its own mark: all others are farther from it, and its line goes
 * over none of them.
 *
 * @param farther how many times as far away as its own mark, or as a label beside it.
 */
function isPlain(
  { x, y, away }: Wanted,
  { box, led, line }: Spot,
  marked: Occupied,
  farther: number,
): boolean {
  const isOther = (mark: Box) => {
    const [otherX, otherY] = middle(mark);
    return Math.hypot(otherX - x, otherY - y) > 0.5;
  };
  const least = farther * (led ? away : distance(box, x, y));
  if (!marked.leaves(wider(box, least), (mark) => isOther(mark) && distance(box, ...middle(mark)) < least)) {
    return false;
  }
  return line.every((part) => distance(part, x, y) < away || marked.leaves(part, (mark) => isOther(mark)));
}

/** At the right, left, below or above, then at the corners. */
function beside(text: Text, { x, y, away, [text]: { width, height } }: Wanted): Spot[] {
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
  return corners.map(([x, y], index) => ({
    text,
    led: false,
    index,
    box: { x, y, width, height },
    line: [],
  }));
}

/** All round, the nearer ring first. */
function farOff(text: Text, { x, y, away, rank, [text]: { width, height } }: Wanted): Spot[] {
  return (rank > 0 ? FAR_RINGS_PX : RINGS_PX).flatMap((beyond, ring) =>
    Array.from({ length: ON_RING }, (_, step): Spot => {
      const turn = (2 * Math.PI * step) / ON_RING;
      const box = {
        x: x + (away + beyond + width / 2) * Math.cos(turn) - width / 2,
        y: y + (away + beyond + height / 2) * Math.sin(turn) - height / 2,
        width,
        height,
      };
      return { text, led: true, index: ring * ON_RING + step, box, line: lineTo(box, x, y) };
    }),
  );
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
