/** What one source tells: its newest picture, its clock, and the state of the way to it. */

import { type Picture, pictureOf, withDelta } from "../domain/picture";
import { heard, type IncidentClock } from "../domain/time/clock";
import type { DeltaMessage, FrameMessage, HeartbeatMessage } from "../domain/types";
import { type LinkState, NOT_CONNECTED, type Source } from "../sources/source";

const STANDING: IncidentClock = { t: 0, localMs: 0, rate: 0 };

export interface FeedOwner {
  /** Incident seconds per local second, between two messages. */
  rate(): number;
  /** Its time only goes on: what tells an earlier moment has been long under way. */
  readonly onward: boolean;
  /** A frame or delta has changed the picture; `asked`: to what is asked for, not to what was. */
  changed(message: FrameMessage | DeltaMessage, asked: boolean): void;
  heartbeat(message: HeartbeatMessage): void;
  lost(): void;
  /** The link is open again after it was lost. */
  back(): void;
}

export class Feed {
  picture = $state.raw<Picture | null>(null);
  link = $state.raw<LinkState>(NOT_CONNECTED);
  clock = $state.raw<IncidentClock>(STANDING);
  private source: Source | null = null;

  constructor(private readonly owner: FeedOwner) {}

  /** Hears another source; `kept`: what the one before showed stays, at its moment, until this one shows something. */
  follow(source: Source, kept = false): void {
    const { picture, clock } = this;
    this.leave();
    if (kept) {
      this.picture = picture;
      this.clock = clock;
    }
    this.source = source;
    source.subscribe({
      frame: (message, t) => this.take(message, pictureOf(message), t),
      delta: (message, t) => {
        if (this.picture !== null) this.take(message, withDelta(this.picture, message), t);
      },
      heartbeat: (message, t) => {
        if (t === null) return;
        this.owner.heartbeat(message);
        this.told(t);
      },
      state: (link) => {
        const before = this.link.link;
        this.link = link;
        if (link.link === "lost" && before !== "lost") this.owner.lost();
        if (link.link === "open" && before === "lost") this.owner.back();
      },
    });
  }

  /** Whether nothing is heard of it. The first attempt is no loss before it has failed, or said nothing for long. */
  get isLost(): boolean {
    return this.link.link === "lost";
  }

  /** Forgets the source and what it showed. */
  leave(): void {
    this.source?.close();
    this.source = null;
    this.picture = null;
    this.link = NOT_CONNECTED;
    this.clock = STANDING;
  }

  /** What is shown is of another moment than the one that is asked for, and nothing comes in its place. */
  blank(): void {
    this.picture = null;
  }

  /** Incident time is `t` now, and goes on from there. */
  keepTime(t: number): void {
    this.clock = { t, localMs: performance.now(), rate: this.owner.rate() };
  }

  private take(message: FrameMessage | DeltaMessage, picture: Picture, t: number | null): void {
    this.picture = picture;
    this.owner.changed(message, t !== null);
    // A picture of the past never stands under another moment than its own.
    this.told(t ?? message.clock_t);
  }

  private told(t: number): void {
    const { clock, owner } = this;
    if (owner.onward) this.clock = heard(clock, t, performance.now(), owner.rate());
    else this.keepTime(t);
  }
}
