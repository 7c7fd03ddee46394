import { expect, test } from "vitest";
import { distance, overlap } from "./boxes";
import { labelPlaces, MOST_LED, type Spot, type Wanted } from "./label-places";
import type { Box } from "./layer";

const MAP = { width: 800, height: 600 };
const MARK = 13;
const NOWHERE_BEFORE: ReadonlyMap<string, Spot> = new Map();

function wants(node: string, x: number, y: number, always = false, rank = 0): Wanted {
  const [whole, short] = [
    { width: 130, height: 37 },
    { width: 80, height: 21 },
  ];
  return { node, x, y, away: MARK + 6, whole, short, brief: short, always, rank };
}

const markOf = ({ x, y }: Wanted): Box => ({ x: x - MARK, y: y - MARK, width: 2 * MARK, height: 2 * MARK });

function placed(all: readonly Wanted[], before = NOWHERE_BEFORE, covered: readonly Box[] = []) {
  return labelPlaces(all, all.map(markOf), covered, MAP, before);
}

/** So many shoulder to shoulder, a few pixels apart. */
const crowd = (people: number) =>
  Array.from({ length: people }, (_, i) => wants(`ff${i}`, 400 + 9 * (i % 4), 300 + 7 * Math.floor(i / 4)));

test("who stands alone has the whole label at the right of the mark", () => {
  const spot = placed([wants("ff1", 400, 300)]).get("ff1");
  expect(spot?.text).toBe("whole");
  expect(spot?.box).toEqual({ x: 419, y: 281.5, width: 130, height: 37 });
});

test.each([2, 3, 6, 12])(
  "of %i who stand shoulder to shoulder each has a label, off all others and all marks",
  (people) => {
    const all = crowd(people);
    const spots = placed(all);
    expect([...spots.keys()].sort()).toEqual(all.map(({ node }) => node).sort());
    const boxes = [...spots.values()].map(({ box }) => box);
    const marks = all.map(markOf);
    for (const [i, box] of boxes.entries()) {
      expect([...boxes.slice(i + 1), ...marks].some((other) => overlap(box, other))).toBe(false);
      expect(
        box.x >= 0 && box.y >= 0 && box.x + box.width <= MAP.width && box.y + box.height <= MAP.height,
      ).toBe(true);
    }
  },
);

test("a label beside the mark comes before one with a line, the whole one first", () => {
  const apart = [wants("ff1", 400, 100), wants("ff2", 400, 300), wants("ff3", 400, 500)];
  expect([...placed(apart).values()].map(({ text, led }) => [text, led])).toEqual(
    apart.map(() => ["whole", false]),
  );
  const buttons = { x: 505, y: 0, width: 295, height: 600 };
  const all = [wants("ff1", 400, 100), wants("ff2", 400, 40), wants("ff3", 400, 160), wants("ff4", 310, 100)];
  const { text, led } = placed(all, NOWHERE_BEFORE, [buttons]).get("ff1") ?? {};
  expect([text, led]).toEqual(["short", false]);
});

test("a label is not written where it would be taken for another's, with a line rather than so", () => {
  const [walker, other] = [wants("walker", 400, 300), wants("other", 300, 255)];
  const buttons = { x: 414, y: 0, width: 386, height: 600 };
  const marks = [walker, other].map(markOf);
  for (const covered of [[buttons], [buttons, { x: 0, y: 325, width: 800, height: 30 }]]) {
    const spot = labelPlaces([walker], marks, covered, MAP, NOWHERE_BEFORE).get("walker");
    if (spot === undefined) throw new Error("the walker has no label");
    expect(distance(spot.box, other.x, other.y)).toBeGreaterThan(
      spot.led ? other.away : 1.5 * distance(spot.box, walker.x, walker.y),
    );
  }
});

test("a line goes between the marks of others: the label is not taken for theirs", () => {
  const amidst = wants("amidst", 400, 300);
  const others = [wants("e", 456, 300), wants("w", 344, 300), wants("n", 400, 244), wants("s", 400, 356)];
  const marks = [amidst, ...others].map(markOf);
  const spot = labelPlaces([amidst], marks, [], MAP, NOWHERE_BEFORE).get("amidst");
  expect(spot?.led).toBe(true);
  expect(spot?.line.some((part) => others.map(markOf).some((mark) => overlap(part, mark)))).toBe(false);
  for (const { x, y, away } of others) expect(spot && distance(spot.box, x, y)).toBeGreaterThan(away);
});

test("where there is no room for what else would be said, a briefer label says whose mark it is", () => {
  const long = {
    ...wants("unsure", 400, 300),
    short: { width: 260, height: 21 },
    whole: { width: 240, height: 37 },
  };
  const between = (left: number, right: number) => {
    const sides = [
      { x: 0, y: 0, width: left, height: 600 },
      { x: right, y: 0, width: 800 - right, height: 600 },
    ];
    return placed([long], NOWHERE_BEFORE, sides).get("unsure")?.text;
  };
  expect([between(250, 550), between(300, 500)]).toEqual(["whole", "brief"]);
});

test("among more than can be followed those who matter more have their lines", () => {
  const all = crowd(MOST_LED + 20).map((label, at) => ({ ...label, rank: at < 2 ? 1 : 0 }));
  const spots = placed(all);
  expect([spots.has("ff0"), spots.has("ff1")]).toEqual([true, true]);
  expect([...spots].filter(([node, { led }]) => led && node !== "ff0" && node !== "ff1")).toEqual([]);
});

test("a line goes round the label of another where there is a way", () => {
  const other = { ...wants("other", 452, 300), whole: { width: 20, height: 37 } };
  const walls = { x: 200, y: 200, width: 270, height: 200 };
  const spots = labelPlaces([other, wants("walled-in", 400, 300)], [walls], [], MAP, NOWHERE_BEFORE);
  const [beside, led] = [spots.get("other"), spots.get("walled-in")];
  expect([beside?.text, beside?.led, led?.led]).toEqual(["whole", false, true]);
  expect(led?.line.some((part) => beside && overlap(part, beside.box))).toBe(false);
});

test("of more people than anyone could follow lines to, none has a line", () => {
  const spots = placed(crowd(MOST_LED + 1));
  expect([...spots.values()].some(({ led }) => led)).toBe(false);
  expect(spots.size).toBeGreaterThan(0);
});

test("a label stays on its side of the mark when the better one becomes free", () => {
  const [walker, other] = [wants("walker", 400, 300), wants("other", 460, 300)];
  const first = placed([walker, other]);
  expect(first.get("walker")?.index).not.toBe(0);
  const apart = placed([walker, { ...other, x: 700 }], first);
  expect(apart.get("walker")?.index).toBe(first.get("walker")?.index);
});

test("a short label becomes whole again as soon as there is room", () => {
  const all = crowd(12);
  const crowded = placed(all);
  const short = all.find(({ node }) => crowded.get(node)?.text !== "whole");
  if (short === undefined) throw new Error("all twelve labels are whole");
  expect(placed([short], crowded).get(short.node)?.text).toBe("whole");
});

test("no label lies under the buttons; who is in alarm is labelled also where nothing is free", () => {
  const buttons = { x: 410, y: 0, width: 390, height: 600 };
  expect(placed([wants("ff1", 400, 300)], NOWHERE_BEFORE, [buttons]).get("ff1")?.index).toBe(1);
  const everywhere = { x: 0, y: 0, ...MAP };
  const both = [wants("mayday", 400, 300, true), wants("ff1", 600, 300)];
  expect([...placed(both, NOWHERE_BEFORE, [everywhere]).keys()]).toEqual(["mayday"]);
});

test("who is in alarm among marks and buttons is labelled more briefly over marks, rather than under a button", () => {
  const buttons = [
    { x: 0, y: 0, width: 375, height: 600 },
    { x: 500, y: 0, width: 300, height: 600 },
  ];
  const marks = Array.from({ length: 60 }, (_, row) => ({ x: 375, y: 10 * row, width: 125, height: 10 }));
  const spot = labelPlaces([wants("mayday", 400, 300, true)], marks, buttons, MAP, NOWHERE_BEFORE).get(
    "mayday",
  );
  expect(spot?.text).toBe("short");
  expect(buttons.some((button) => spot === undefined || overlap(spot.box, button))).toBe(false);
});

test("in a crowd that nobody could follow lines to, whoever must be labelled is, off all others and all marks", () => {
  const must = [wants("chosen", 404, 304, true), wants("mayday", 412, 310, true)];
  const all = [...must, ...crowd(50)];
  const spots = placed(all);
  const boxes = must.map(({ node }) => spots.get(node)?.box ?? { x: 0, y: 0, ...MAP });
  const others = [...spots].flatMap(([node, { box }]) =>
    must.some((one) => one.node === node) ? [] : [box],
  );
  const [chosen, mayday] = boxes;
  expect(chosen && mayday && overlap(chosen, mayday)).toBe(false);
  for (const box of boxes)
    expect([...others, ...all.map(markOf)].some((one) => overlap(box, one))).toBe(false);
});

const NAME = { x: 430, y: 290, width: 50, height: 14 };

test("a label that looks for its place leaves the name of a breadcrumb free, where there is room beside it", () => {
  const all = [wants("ff1", 400, 300)];
  const spot = labelPlaces(all, all.map(markOf), [], MAP, NOWHERE_BEFORE, [NAME]).get("ff1");
  expect(spot?.text).toBe("whole");
  expect(overlap(spot?.box ?? NAME, NAME)).toBe(false);
});

test("who walks past a breadcrumb keeps the label where it is: one that jumps about is not read", () => {
  const all = [wants("ff1", 400, 300)];
  const before = labelPlaces(all, all.map(markOf), [], MAP, NOWHERE_BEFORE);
  expect(labelPlaces(all, all.map(markOf), [], MAP, before, [NAME])).toEqual(before);
});

test("a label is not given up for a name: somebody matters more than what he dropped", () => {
  const all = [wants("ff1", 400, 300)];
  const everywhere = { x: 0, y: 0, ...MAP };
  const spot = labelPlaces(all, all.map(markOf), [], MAP, NOWHERE_BEFORE, [everywhere]).get("ff1");
  expect(spot?.text).toBe("whole");
});
