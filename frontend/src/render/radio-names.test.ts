import { describe, expect, test } from "vitest";
import { FIRST_VIEW, resize, toLocal } from "../domain/map/view";
import { aNode, pictureWith } from "../domain/samples";
import { overlap } from "./boxes";
import { boxOf, radioNames, readable } from "./radio-names";
import { aScene } from "./samples";

const row = (names: string[], apart_px: number) =>
  names.map((text, at) => ({ text, x: apart_px * at, y: 100 }));
const texts = (names: string[], apart_px: number) => readable(row(names, apart_px)).map(({ text }) => text);

test("names of radios that stand in a row are read apart, and what has no room is left out", () => {
  expect(texts(["b1", "b2", "b3"], 40)).toEqual(["b1", "b2", "b3"]);
  // At 15 px they would touch: "b1b2b3".
  expect(texts(["b1", "b2", "b3"], 15)).toEqual(["b1", "b3"]);
});

test("of two that lie too near to be read apart, the one that fell silent or was moved is named", () => {
  const view = resize(FIRST_VIEW, 800, 600);
  const radio = (node: string, x: number, over = {}) =>
    aNode({ node, role: "breadcrumb", position_m: [...toLocal(view, x, 300), 0], ...over });
  const named = (over: object) =>
    radioNames(aScene({ view, picture: pictureWith(radio("b1", 400), radio("b2", 410, over)) }));
  expect(named({}).map(({ text }) => text)).toEqual(["b1"]);
  expect(named({ moved: true }).map(({ text }) => text)).toEqual(["b2 MOVED"]);
  expect(named({ status: "lost" }).map(({ text }) => text)).toEqual(["b2 silent"]);
});

describe("of a radio over whose name somebody stands", () => {
  const view = resize(FIRST_VIEW, 800, 600);
  const at = (x: number, y: number) => [...toLocal(view, x, y), 0] as [number, number, number];
  const named = (over: object, ...people: [number, number][]) => {
    const radio = aNode({ node: "L3-B6", role: "breadcrumb", position_m: at(400, 300), ...over });
    const stand = people.map(([x, y], index) => aNode({ node: `ff${index}`, position_m: at(x, y) }));
    return radioNames(aScene({ view, picture: pictureWith(radio, ...stand) }));
  };
  const people: [number, number][] = [
    [400, 320],
    [400, 280],
    [430, 300],
  ];

  test("it is said on another side that it was moved or fell silent", () => {
    for (const over of [{ moved: true }, { status: "lost" }]) {
      for (const count of [1, 2, 3]) {
        const [name] = named(over, ...people.slice(0, count));
        expect(name?.text).toMatch(/L3-B6 (MOVED|silent)/);
        for (const [x, y] of people.slice(0, count)) {
          expect(name && overlap(boxOf(name), { x: x - 13, y: y - 13, width: 26, height: 26 })).toBe(false);
        }
      }
    }
  });

  test("it is said under it where there is no other room", () => {
    const around = [370, 340].flatMap((x) => [280, 300, 320].map((y): [number, number] => [x, y]));
    const names = named({ moved: true }, ...people, ...around, [430, 320], [430, 280]);
    expect(names).toEqual([expect.objectContaining({ text: "L3-B6 MOVED", x: 400, y: 309 })]);
  });

  test("no half of a name is left that says nothing but itself", () => {
    expect(named({}).map(({ text }) => text)).toEqual(["L3-B6"]);
    expect(named({}, [415, 320])).toEqual([]);
  });
});
