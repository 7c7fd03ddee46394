/** Looking at the past of an incident: from which moment, how fast, and what the record shows of it. */
import { type Extent, within } from "../domain/time/timeline";
import type { Incident } from "../domain/types";
import { ReplaySource } from "../sources/replay-source";
import { Feed } from "./feed.svelte";

export interface ReplayOwner {
  readonly incident: Incident | null;
  /** What the timeline spans. */
  readonly extent: Extent;
  /** Incident time of what is shown (Unix s). */
  readonly now: number;
  /** There is a picture of the present to look at until the past has come. */
  readonly showsPresent: boolean;
}

export class Replay {
  /** The past is looked at, or asked for. */
  on = $state(false);
  /** It is what is shown: until its first picture has come, the present stays, and says that it is. */
  shown = $state(false);
  paused = $state(false);
  speed = $state(1);
  /** The moment that was asked for and is not shown yet (Unix s): until then the clock stands with what is shown. */
  soughtT = $state<number | null>(null);
  readonly feed: Feed = new Feed({
    onward: false,
    rate: () => (this.paused || this.feed.isLost || this.soughtT !== null ? 0 : this.speed),
    changed: (_, asked) => {
      this.shown = true;
      if (asked) this.soughtT = null;
    },
    heartbeat: ({ ended }) => {
      if (!ended || this.paused) return;
      this.paused = true;
      // Whoever goes back from the end would else be shown a replay that goes on under the word that it stands.
      this.source?.setPaused(true);
    },
    // The past does not age because nobody tells of it: it stands still until it is heard again.
    lost: () => this.feed.keepTime(this.owner.now),
    back: () => undefined,
  });
  private source: ReplaySource | null = null;
  /** What the source can seek. */
  private reach: Extent = { from: 0, to: 0 };

  constructor(private readonly owner: ReplayOwner) {}

  /** Shows the incident as it was at `t` (Unix s), and goes on from there. */
  begin(t: number, paused: boolean): void {
    const { incident, extent } = this.owner;
    if (incident === null) return;
    const { from, to } = extent;
    const begin = Math.max(0, Math.min(from, t));
    const end = Math.max(to, t);
    const at = within({ from: begin, to: end }, t);
    this.reach = { from: begin, to: end };
    this.source = new ReplaySource(incident.id, { begin, at, to: end, speed: this.speed, paused });
    const shownT = this.owner.now;
    this.feed.follow(this.source, !this.feed.isLost);
    this.paused = paused;
    this.shown = this.on ? this.shown : !this.owner.showsPresent;
    this.on = true;
    this.soughtT = at;
    this.feed.keepTime(this.feed.picture === null ? at : shownT);
  }

  /** Back to what is now. */
  end(): void {
    this.on = false;
    this.shown = false;
    this.paused = false;
    this.speed = 1;
    this.soughtT = null;
    this.feed.leave();
    this.source = null;
  }

  seek(t: number): void {
    const at = within(this.owner.extent, t);
    // The incident goes on while its past is looked at: what came since needs a wider replay.
    if (this.source === null || within(this.reach, at) !== at) {
      this.begin(at, this.source === null || this.paused);
      return;
    }
    this.source.seek(at);
    this.soughtT = at;
    if (this.feed.isLost) this.feed.blank();
    this.feed.keepTime(this.feed.picture === null ? at : this.owner.now);
  }

  /** Pauses or goes on; from live: pauses here. */
  setPaused(paused: boolean): void {
    if (this.source === null) {
      this.begin(this.owner.now, true);
      return;
    }
    const t = this.owner.now;
    this.paused = paused;
    this.source.setPaused(paused);
    this.feed.keepTime(t);
  }

  setSpeed(speed: number): void {
    const t = this.owner.now;
    this.speed = speed;
    if (this.source === null) return;
    this.source.setSpeed(speed);
    this.feed.keepTime(t);
  }
}
