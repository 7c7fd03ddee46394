/** A scene for the tests of this folder: a night with nobody there, with what a test is about put over it. */

import { DEFAULT_LIMITS } from "../domain/fixes/staleness";
import { Trails } from "../domain/map/trails";
import { FIRST_VIEW, resize } from "../domain/map/view";
import { NOON } from "../domain/samples";
import { PALETTES } from "../ui/themes";
import type { Scene } from "./layer";

export function aScene(over: Partial<Scene> = {}): Scene {
  return {
    view: resize(FIRST_VIEW, 800, 600),
    palette: PALETTES.night,
    picture: null,
    now: NOON,
    levels: [],
    level: "all",
    limits: DEFAULT_LIMITS,
    crews: new Map(),
    alarms: new Map(),
    selected: null,
    trails: new Trails(),
    trail_s: 0,
    knownNow: new Map(),
    knownTracks: [],
    covered: [],
    ...over,
  };
}
