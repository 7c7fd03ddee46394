import { expect, test } from "vitest";
import { FIRST_VIEW, resize, toLocal } from "../domain/map/view";
import { aNode, pictureWith } from "../domain/samples";
import { radioNames, readable } from "./radio-names";
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
