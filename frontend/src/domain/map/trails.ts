/** Where each responder went: a ring buffer of its last positions. */
import type { Position, Track } from "../types";

/** Points kept for each node: 30 min at one a second. */
const CAPACITY = 1800;
/** A trail needs no more than a point per this much time (s). */
const LEAST_STEP_S = 0.5;

/** The last positions of one node, oldest first. */
export class Trail {
  private readonly points = new Float64Array(CAPACITY * 3);
  private start = 0;
  length = 0;

  /** Adds a point later than all before; one that is not is ignored. */
  add(t: number, e_m: number, n_m: number): void {
    if (this.length > 0 && t - this.time(this.length - 1) < LEAST_STEP_S) return;
    if (this.length === CAPACITY) {
      this.start = (this.start + 1) % CAPACITY;
      this.length -= 1;
    }
    const at = ((this.start + this.length) % CAPACITY) * 3;
    this.points[at] = t;
    this.points[at + 1] = e_m;
    this.points[at + 2] = n_m;
    this.length += 1;
  }

  time(index: number): number {
    return this.value(index, 0);
  }

  east(index: number): number {
    return this.value(index, 1);
  }

  north(index: number): number {
    return this.value(index, 2);
  }

  /** Index of the first point at or after `t`. */
  firstFrom(t: number): number {
    let low = 0;
    let high = this.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time(middle) < t) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  private value(index: number, field: 0 | 1 | 2): number {
    return this.points[((this.start + index) % CAPACITY) * 3 + field] ?? Number.NaN;
  }
}

/** The trails of one incident. */
export class Trails {
  /** Counts how often other trails took their place; points that are added at their ends change nothing of it. */
  version = 0;
  private readonly byNode = new Map<string, Trail>();

  add(node: string, t: number, position: Position): void {
    let trail = this.byNode.get(node);
    if (trail === undefined) {
      trail = new Trail();
      this.byNode.set(node, trail);
    }
    trail.add(t, position[0], position[1]);
  }

  /** Puts the recorded tracks before what has been seen since. */
  fill(tracks: readonly Track[]): void {
    this.version += 1;
    for (const { node, points } of tracks) {
      const seen = this.byNode.get(node);
      const trail = new Trail();
      for (const [t, e_m, n_m] of points) trail.add(t, e_m, n_m);
      for (let i = 0; seen !== undefined && i < seen.length; i += 1) {
        trail.add(seen.time(i), seen.east(i), seen.north(i));
      }
      this.byNode.set(node, trail);
    }
  }

  of(node: string): Trail | undefined {
    return this.byNode.get(node);
  }

  clear(): void {
    this.version += 1;
    this.byNode.clear();
  }
}

export function trailsOf(tracks: readonly Track[]): Trails {
  const trails = new Trails();
  trails.fill(tracks);
  return trails;
}
