import { expect, test } from "vitest";
import { readable } from "./radios";

const row = (names: string[], apart_px: number) =>
  names.map((text, at) => ({ text, x: apart_px * at, y: 100 }));
const texts = (names: string[], apart_px: number) => readable(row(names, apart_px)).map(({ text }) => text);

test("names of radios that stand in a row are read apart, and what has no room is left out", () => {
  expect(texts(["b1", "b2", "b3"], 40)).toEqual(["b1", "b2", "b3"]);
  // At 15 px they would touch: "b1b2b3".
  expect(texts(["b1", "b2", "b3"], 15)).toEqual(["b1", "b3"]);
});
