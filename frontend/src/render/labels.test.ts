import { expect, test } from "vitest";
import { FIRST_VIEW, resize, toLocal } from "../domain/map/view";
import { aNode, pictureWith } from "../domain/samples";
import { errorNotSeen, labels } from "./labels";
import type { Scene } from "./layer";
import { aScene } from "./samples";
import { scaleBox } from "./scale";

const VIEW = resize(FIRST_VIEW, 800, 600);

/** Where the first letters of all labels come to lie (CSS pixels). */
function written(scene: Scene): [x: number, y: number][] {
  const places: [number, number][] = [];
  const pen = {
    measureText: (text: string) => ({ width: 8 * text.length }),
    fillText: (_: string, x: number, y: number) => places.push([x, y]),
  };
  const context = new Proxy(pen, { get: (known, name) => Reflect.get(known, name) ?? (() => undefined) });
  labels.draw(context as unknown as CanvasRenderingContext2D, scene, false);
  return places;
}

test("no label lies over the arrow to the north or the length of a metre", () => {
  const box = scaleBox(VIEW);
  const beside = toLocal(VIEW, box.width - 60, box.y - 20);
  const node = aNode({ position_m: [...beside, 0] });
  const people = [node, { ...node, node: "ff2" }, { ...node, node: "ff3" }];
  const places = written(aScene({ view: VIEW, picture: pictureWith(...people) }));
  expect(places.length).toBeGreaterThan(3);
  expect(places.filter(([x, y]) => x < box.width && y > box.y)).toEqual([]);
});

test("lines of a label lie as far apart as text is large", () => {
  const scene = aScene({ view: VIEW, picture: pictureWith(aNode({ position_m: [0, 0, 0] })) });
  const apart = (text: number) => {
    const [first, second] = written({ ...scene, view: { ...VIEW, text } });
    return (second?.[1] ?? 0) - (first?.[1] ?? 0);
  };
  expect(apart(1)).toBeGreaterThan(0);
  expect(apart(2)).toBe(2 * apart(1));
});

test("how far off somebody may be is for words only where the ellipse does not show it", () => {
  const errorOf = (sigma_m: number) => {
    const node = aNode({ covariance_m2: [sigma_m ** 2, 0, 0, sigma_m ** 2, 0, 1] });
    return errorNotSeen(aScene({ view: VIEW, picture: pictureWith(node) }), { node });
  };
  expect(errorOf(2)).toBeNull();
  expect(errorOf(80)).toBeCloseTo(80 * 2.448, 0);
});
