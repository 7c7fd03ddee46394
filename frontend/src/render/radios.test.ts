import { expect, test } from "vitest";
import { FIRST_VIEW, resize, toLocal } from "../domain/map/view";
import { aNode, pictureWith } from "../domain/samples";
import { labels } from "./labels";
import type { Scene } from "./layer";
import { radioNames } from "./radio-names";
import { radios } from "./radios";
import { aScene } from "./samples";

const VIEW = resize(FIRST_VIEW, 800, 600);

/** What is written on the map: by the radios, and by the labels over them. */
function written(scene: Scene): [names: string[], labels: string[]] {
  const by = (layer: typeof radios) => {
    const texts: string[] = [];
    const pen = {
      measureText: (text: string) => ({ width: 8 * text.length }),
      fillText: (text: string) => texts.push(text),
    };
    const context = new Proxy(pen, { get: (known, name) => Reflect.get(known, name) ?? (() => undefined) });
    layer.draw(context as unknown as CanvasRenderingContext2D, scene, false);
    return texts;
  };
  return [by(radios), by(labels)];
}

/** A responder in the middle of the map, all around whom breadcrumbs lie a few pixels apart. */
function amongBreadcrumbs(away_px: number) {
  const at = (x: number, y: number): [number, number, number] => [...toLocal(VIEW, x, y), 0];
  const around = Array.from({ length: 24 }, (_, i) => {
    const turn = (2 * Math.PI * i) / 24;
    return aNode({
      node: `b${i}`,
      callsign: null,
      role: "breadcrumb",
      position_m: at(400 + away_px * Math.cos(turn), 300 + away_px * Math.sin(turn)),
    });
  });
  return aScene({ view: VIEW, picture: pictureWith(aNode({ position_m: at(400, 300) }), ...around) });
}

test("the name of a breadcrumb that a label would be written over is left out: two texts in one place are none", () => {
  const scene = amongBreadcrumbs(50);
  const [names, label] = written(scene);
  expect(label.length).toBeGreaterThan(0);
  expect(names.length).toBeGreaterThan(0);
  expect(names.length).toBeLessThan(radioNames(scene).length);
});
