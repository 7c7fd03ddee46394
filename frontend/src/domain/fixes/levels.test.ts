import { expect, test } from "vitest";
import { aNode, pictureWith, STOREYS } from "../samples";
import { levelButtons, levelOf, neighbourLevel, storeysThatFit, storeyWords, withoutEmpty } from "./levels";

test("the estimator's word on the storey stands before the height", () => {
  expect(levelOf(aNode({ level: 2, position_m: [0, 0, 0] }), STOREYS)).toBe(2);
});

test.each([
  [0, 0],
  [2.3, 0],
  [2.5, 1],
  [4, 1],
  [9, 2],
  [-3, 0],
])("a responder at %d m stands on storey %d", (up_m, level) => {
  expect(levelOf(aNode({ position_m: [0, 0, up_m] }), STOREYS)).toBe(level);
});

test("without a position or without storeys the level is unknown", () => {
  expect(levelOf(aNode({ position_m: null }), STOREYS)).toBeNull();
  expect(levelOf(aNode(), [])).toBeNull();
});

test.each([
  [0.64, "Level 1, 64 %"],
  [0.93, "Level 1"],
  [null, "Level 1"],
])("a storey of probability %s is said as %s", (level_p, words) => {
  expect(storeyWords(aNode({ level: 1, level_p }), STOREYS)).toBe(words);
});

test("an unknown storey says so", () => {
  expect(storeyWords(aNode({ position_m: null }), STOREYS)).toBe("storey not known");
});

const picture = pictureWith(
  aNode({ node: "ff1", level: 1 }),
  aNode({ node: "ff2", level: 1 }),
  aNode({ node: "ff3", level: 0 }),
  aNode({ node: "gone", level: 0, status: "retired" }),
  aNode({ node: "b1", role: "breadcrumb", level: 2 }),
);

test("storey buttons stand as the building does and count the responders on each", () => {
  const buttons = levelButtons(picture, STOREYS, new Set(["ff2"]));
  expect(buttons.map(({ name, responders, alarms }) => [name, responders, alarms])).toEqual([
    ["All", 3, 1],
    ["2", 0, 0],
    ["1", 2, 1],
    ["G", 1, 0],
  ]);
});

test("a storey that only a responder knows of gets its button", () => {
  const buttons = levelButtons(pictureWith(aNode({ level: -1 })), STOREYS, new Set());
  expect(buttons.at(-1)).toMatchObject({ level: -1, name: "-1", responders: 1 });
});

test("going up ends at all storeys, going down at the lowest", () => {
  const buttons = levelButtons(picture, STOREYS, new Set());
  expect(neighbourLevel(1, 1, buttons)).toBe(2);
  expect(neighbourLevel(2, 1, buttons)).toBe("all");
  expect(neighbourLevel("all", 1, buttons)).toBe("all");
  expect(neighbourLevel(0, -1, buttons)).toBe(0);
});

test("where not all storeys have room those stay where somebody is or was, and the chosen one", () => {
  const buttons = levelButtons(picture, STOREYS, new Set());
  const names = (room: number, kept: number[] = []) =>
    withoutEmpty(buttons, room, "all", new Set(kept)).map(({ name }) => name);
  expect(names(4)).toEqual(["All", "2", "1", "G"]);
  expect(names(3)).toEqual(["All", "1", "G"]);
  expect(names(3, [2])).toEqual(["All", "2", "1", "G"]);
  expect(withoutEmpty(buttons, 3, 2, new Set()).map(({ level }) => level)).toEqual(["all", 2, 1, 0]);
});

test("as many storeys fit as two columns hold, however low the map is", () => {
  expect(storeysThatFit({ width: 704, height: 430 })).toBe(14);
  expect(storeysThatFit({ width: 704, height: 60 })).toBe(2);
});
