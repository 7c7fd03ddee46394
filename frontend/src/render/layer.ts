/** What a map layer is: it draws one kind of thing of a scene. A new layer is one new file. */

import type { KnownNow } from "../domain/fixes/known-now";
import type { LevelChoice } from "../domain/fixes/levels";
import type { StalenessLimits } from "../domain/fixes/staleness";
import type { Trails } from "../domain/map/trails";
import type { View } from "../domain/map/view";
import type { CrewMark } from "../domain/people/crews";
import type { Picture } from "../domain/picture";
import type { FrameAlarm, FrameNode, Level, Track } from "../domain/types";
import type { Palette } from "../ui/themes";

/** Everything that the map shows, at one moment. */
export interface Scene {
  readonly view: View;
  readonly palette: Palette;
  readonly picture: Picture | null;
  /** Incident time (Unix s). */
  readonly now: number;
  readonly levels: readonly Level[];
  readonly level: LevelChoice;
  readonly limits: StalenessLimits;
  readonly crews: ReadonlyMap<string, CrewMark>;
  readonly alarms: ReadonlyMap<string, FrameAlarm>;
  readonly selected: string | null;
  readonly trails: Trails;
  /** Length of the trails shown (s); 0 hides them. */
  readonly trail_s: number;
  /** Where they were as known now, and how they came there: beside a picture of the past, where it is wanted. */
  readonly knownNow: ReadonlyMap<string, KnownNow>;
  readonly knownTracks: readonly Track[];
  /** What lies over the map: no label goes there. */
  readonly covered: readonly Box[];
}

/** A rectangle of the map (CSS pixels). */
export interface Box {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export interface Layer {
  /** @param moving the map is under a finger: what is dear to draw may be as it was, moved along. */
  draw(context: CanvasRenderingContext2D, scene: Scene, moving: boolean): void;
}

/** A node where it is drawn (CSS pixels). */
export interface Placed {
  readonly node: FrameNode;
  readonly x: number;
  readonly y: number;
  /** It is on a storey that is not the chosen one, and in no alarm: it is only a shadow. */
  readonly elsewhere: boolean;
}
