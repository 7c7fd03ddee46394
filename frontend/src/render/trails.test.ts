import { describe, expect, test } from "vitest";
import { Trail, Trails } from "../domain/map/trails";
import { FIRST_VIEW, pan, resize } from "../domain/map/view";
import { aNode, NOON, pictureWith, STOREYS } from "../domain/samples";
import type { Scene } from "./layer";
import { aScene } from "./samples";
import { corners, stillHolds, walkedOf } from "./trails";

const MAP = { ...resize(FIRST_VIEW, 800, 600), pixelsPerMetre: 10 };

/** Somebody who walks east, a tenth of a metre a second, seen at these seconds. */
function walked(seconds: readonly number[]): Trail {
  const trail = new Trail();
  for (const t of seconds) trail.add(t, 0.1 * t, 0);
  return trail;
}

test("of steps too short to be seen few are drawn, and the trail is as long as the walk", () => {
  const drawn = [...corners(walked([...Array(101).keys()]), MAP, 0, 100)];
  expect(drawn.length).toBeLessThan(25);
  expect([drawn[0]?.x, drawn.at(-1)?.x]).toEqual([400, 500]);
});

test("where the walk is not known nothing is drawn, however near it goes on", () => {
  const drawn = [...corners(walked([0, 1, 2, 30, 31]), MAP, 0, 4)];
  expect(drawn.filter(({ gap }) => gap).map(({ x }) => x)).toEqual([400, 430]);
});

describe("what was drawn of a walk", () => {
  const trails = new Trails();
  const scene = aScene({ view: MAP, trails, picture: pictureWith(aNode()), trail_s: 300 });
  const drawn = walkedOf(scene);
  const holds = (over: Partial<Scene>, moving = false) =>
    stillHolds(drawn, walkedOf({ ...scene, ...over }), 300, moving);

  test("is drawn again only every few seconds while nobody touches the map", () => {
    const walkedOn = aNode({ position_m: [1, 0, 0], t: NOON + 4 });
    expect(holds({ picture: pictureWith(walkedOn), now: NOON + 4 })).toBe(true);
    expect(holds({ now: NOON + 6 })).toBe(false);
  });

  test("is drawn again at once where others are to be seen, or others' trails", () => {
    expect(holds({ selected: "ff1" })).toBe(false);
    expect(holds({ now: NOON - 60 })).toBe(false);
    expect(holds({ level: 1, levels: STOREYS })).toBe(false);
    expect(holds({ picture: { ...pictureWith(aNode()), incident: "i2" } })).toBe(false);
    expect(holds({ trails: new Trails() })).toBe(false);
    trails.fill([]);
    expect(holds({})).toBe(false);
    trails.version -= 1;
  });

  test("moves along with a map under a finger, and is drawn again when the map rests", () => {
    expect(holds({ view: pan(MAP, 5, 0) }, true)).toBe(true);
    expect(holds({ view: pan(MAP, 5, 0) })).toBe(false);
  });
});
