import { expect, test } from "vitest";
import { contrast } from "../contrast";
import { aNode } from "../samples";
import { crewMarks, markOf } from "./crews";

const crews = (...names: string[]) => crewMarks(names.map((crew) => aNode({ crew })));

test("crews get the same marks in whatever order they come, so that all screens agree", () => {
  expect([...crews("E7", "E5", "T1")]).toEqual([...crews("T1", "E5", "E7")]);
});

test.each([
  ["E7", "E7"],
  ["Truck 12", "T12"],
  ["Engine Company 7", "EC7"],
  ["Battalion 1204", "204"],
  ["Attack North", "AN"],
  ["Rescue", "Res"],
  ["!", "?"],
])("a mark carries letters of its crew as well as a colour: of %s %s", (crew, letters) => {
  expect(crews(crew).get(crew)?.letters).toBe(letters);
});

test("of more crews of one kind than there are colours, no two have the same mark", () => {
  const names = Array.from({ length: 12 }, (_, at) => `Engine ${at + 1}`);
  const marks = [...crews(...names).values()].map(({ letters, colour }) => `${letters} ${colour}`);
  expect(new Set(marks).size).toBe(names.length);
});

test("letters can be read on every crew's colour", () => {
  for (const mark of crews("1", "2", "3", "4", "5", "6", "7").values()) {
    expect(contrast(mark.colour, mark.ink)).toBeGreaterThanOrEqual(4.5);
  }
});

test("no crew has a colour near the red of alarms", () => {
  for (const { colour } of crews("1", "2", "3", "4", "5", "6").values()) {
    const [r = 0, g = 0, b = 0] = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
    expect(r > 150 && g < 100 && b < 100).toBe(false);
  }
});

test("aircraft and responders without a crew have marks of their own", () => {
  const marks = crews("E7");
  expect(markOf(aNode({ role: "uav" }), marks).letters).toBe("UAV");
  expect(markOf(aNode({ crew: null, node: "ff12", callsign: null }), marks).letters).toBe("f12");
  expect(markOf(aNode({ crew: null, callsign: "!" }), marks).letters).toBe("?");
});
