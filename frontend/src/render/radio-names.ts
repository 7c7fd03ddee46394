/** The names of what stands, as far as there is room for them: where each is written, and what it takes up. */
import { statusAt } from "../domain/fixes/staleness";
import { overlap } from "./boxes";
import type { Box, Placed, Scene } from "./layer";
import { markReach, movers, radios } from "./place";

/** From this scale on breadcrumbs carry their names (pixels per metre). */
const NAMED_FROM = 14;
const NEAR_ENOUGH_TO_NAME = 40;
/** Width of a character of a name, about (px). */
const CHARACTER_PX = 7;
/** Names nearer to each other are read as one (px). */
const APART_PX = 8;
const LINE_PX = 14;
/** How far under its mark a name begins (CSS pixels). */
const UNDER_PX = 9;
/** Of the mark itself (CSS pixels). */
const MARK_RADIUS = 9;

export interface Name {
  readonly text: string;
  /** The middle of its upper edge (CSS pixels). */
  readonly x: number;
  readonly y: number;
}

const namesOf = new WeakMap<Scene, readonly Name[]>();

/** The names that are written, worked out once for a scene. */
export function radioNames(scene: Scene): readonly Name[] {
  let names = namesOf.get(scene);
  if (names === undefined) {
    const all = radios(scene);
    const named = scene.view.pixelsPerMetre >= NAMED_FROM || all.length <= NEAR_ENOUGH_TO_NAME;
    const people = peopleOver(scene);
    const wanted = all
      .flatMap(({ node, x, y, elsewhere }) => {
        const flagged = isFlagged(scene, node);
        const name = elsewhere
          ? null
          : beside({ text: words(scene, node), x, y }, flagged, people, scene.view.text);
        return name === null ? [] : [{ ...name, said: Number(flagged) }];
      })
      // That one fell silent or was moved is worth more room than how another is called.
      .sort((a, b) => b.said - a.said);
    names = named ? readable(wanted, scene.view.text) : [];
    namesOf.set(scene, names);
  }
  return names;
}

/** What the marks of responders and UAVs lie over. */
function peopleOver(scene: Scene): Box[] {
  return movers(scene).flatMap(({ node, x, y, elsewhere }) => {
    const reach = markReach(scene, node);
    return elsewhere ? [] : [{ x: x - reach, y: y - reach, width: 2 * reach, height: 2 * reach }];
  });
}

/**
 * Where the name of a radio at (x, y) is written: under its mark. Where somebody stands over that, there is none, but
 * that it fell silent or was moved (`flagged`) is said on another side: who walks by must not hide it.
 */
function beside({ text, x, y }: Name, flagged: boolean, people: readonly Box[], size: number): Name | null {
  const aside = MARK_RADIUS + 3 + (text.length * CHARACTER_PX * size) / 2;
  const line = LINE_PX * size;
  const under = { text, x, y: y + UNDER_PX };
  const over = y - UNDER_PX - line;
  const sides = [
    { text, x, y: over },
    ...[y - line / 2, under.y, over].flatMap((top) => [
      { text, x: x + aside, y: top },
      { text, x: x - aside, y: top },
    ]),
  ];
  const places = flagged ? [under, ...sides] : [under];
  const seen = places.find((name) => !people.some((mark) => overlap(mark, boxOf(name, size))));
  return seen ?? (flagged ? under : null);
}

/** What marks and names of radios take up. */
export function radioBoxes(scene: Scene): Box[] {
  const marks = radios(scene).flatMap(({ x, y, elsewhere }) =>
    elsewhere
      ? []
      : [{ x: x - MARK_RADIUS, y: y - MARK_RADIUS, width: 2 * MARK_RADIUS, height: 2 * MARK_RADIUS }],
  );
  return [...marks, ...radioNames(scene).map((name) => boxOf(name, scene.view.text))];
}

/** What a name takes up, with text so many times its usual size. */
export function boxOf({ text, x, y }: Name, size = 1): Box {
  const width = text.length * CHARACTER_PX * size;
  return { x: x - width / 2, y, width, height: LINE_PX * size };
}

/** The names that have room: those that would lie over one before them are left out. The marks tell more than a smear. */
export function readable(names: readonly Name[], size = 1): Name[] {
  const kept: Name[] = [];
  const half = ({ text }: Name) => (text.length * CHARACTER_PX * size) / 2;
  for (const name of names) {
    const over = kept.some(
      (other) =>
        Math.abs(other.y - name.y) < LINE_PX * size &&
        Math.abs(other.x - name.x) < half(other) + half(name) + APART_PX,
    );
    if (!over) kept.push(name);
  }
  return kept;
}

function isFlagged(scene: Scene, node: Placed["node"]): boolean {
  return node.status !== "retired" && (node.moved || statusAt(node, scene.now, scene.limits) !== "live");
}

function words(scene: Scene, node: Placed["node"]): string {
  if (node.status === "retired") return `${node.node} gone`;
  if (node.moved) return `${node.node} MOVED`;
  return statusAt(node, scene.now, scene.limits) === "live" ? node.node : `${node.node} silent`;
}
