/** Rectangles of the map: which of them meet, and which lie near a place. */
import type { Box } from "./layer";

const CELL_PX = 64;

/** Whether two boxes have a part in common. */
export function overlap(a: Box, b: Box): boolean {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

export function inside({ x, y, width, height }: Box, map: Pick<Box, "width" | "height">): boolean {
  return x >= 0 && y >= 0 && x + width <= map.width && y + height <= map.height;
}

/** The nearest point of a box. */
export function nearest(box: Box, x: number, y: number): [number, number] {
  const between = (value: number, least: number, size: number) =>
    Math.min(Math.max(value, least), least + size);
  return [between(x, box.x, box.width), between(y, box.y, box.height)];
}

/** How far it is from a place to a box (CSS pixels). */
export function distance(box: Box, x: number, y: number): number {
  const [toX, toY] = nearest(box, x, y);
  return Math.hypot(toX - x, toY - y);
}

export function middle({ x, y, width, height }: Box): [number, number] {
  return [x + width / 2, y + height / 2];
}

/** A box that goes so much further on each side. */
export function wider({ x, y, width, height }: Box, by: number): Box {
  return { x: x - by, y: y - by, width: width + 2 * by, height: height + 2 * by };
}

/** Boxes by the cells of a grid that they touch, so that each is held against its neighbours alone. */
export class Occupied {
  private readonly cells = new Map<number, Box[]>();

  constructor(boxes: readonly Box[]) {
    for (const box of boxes) this.add(box);
  }

  add(box: Box): void {
    for (const cell of cellsOf(box)) {
      const there = this.cells.get(cell);
      if (there) there.push(box);
      else this.cells.set(cell, [box]);
    }
  }

  /** Whether a box overlaps none of them, or none of which a condition holds. */
  leaves(box: Box, counts: (other: Box) => boolean = () => true): boolean {
    return !cellsOf(box).some((cell) =>
      this.cells.get(cell)?.some((other) => overlap(box, other) && counts(other)),
    );
  }
}

function cellsOf({ x, y, width, height }: Box): number[] {
  const cells: number[] = [];
  for (let row = Math.floor(y / CELL_PX); row * CELL_PX <= y + height; row += 1) {
    for (let column = Math.floor(x / CELL_PX); column * CELL_PX <= x + width; column += 1) {
      cells.push(row * 1024 + column);
    }
  }
  return cells;
}
