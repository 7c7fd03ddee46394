/** Tracks for a replay, around the moment that is shown: asked for when they are wanted, a stretch of time at once. */
import type { Track } from "../domain/types";
import { AGAIN_MS, patiently } from "./patience";

/** So much before and after the moment that is shown is asked for (s). */
const REACH_S = 900;

/** @returns the tracks between two moments (Unix s) */
export type AskTracks = (from: number, to: number, signal: AbortSignal) => Promise<Track[]>;

export class TracksAround {
  /** They are wanted. */
  on = $state(false);
  tracks = $state.raw<readonly Track[]>([]);
  /** The server works it out. */
  busy = $state(false);
  trouble = $state<string | null>(null);
  private loaded = { from: 0, to: 0 };
  private asking = new AbortController();

  constructor(
    private readonly ask: AskTracks,
    private readonly againMs = AGAIN_MS,
  ) {}

  toggle(): void {
    if (this.on) this.leave();
    else this.on = true;
  }

  /** What was asked for is not wanted any more, or is of another incident. */
  leave(): void {
    this.asking.abort();
    this.on = this.busy = false;
    this.trouble = null;
    this.tracks = [];
    this.loaded = { from: 0, to: 0 };
  }

  /**
   * A moment is shown (Unix s): asks for what is around it where it is wanted and not there.
   *
   * @param lead_s what is shown of the time before each moment (s).
   */
  async shows(t: number, lead_s = 0): Promise<void> {
    const { from, to } = this.loaded;
    if (!this.on || this.busy || this.trouble !== null || (t - lead_s >= from && t < to)) return;
    this.busy = true;
    const asking = new AbortController();
    this.asking = asking;
    const now = Math.floor(t);
    const stretch = { from: Math.max(0, now - REACH_S - lead_s), to: now + REACH_S };
    try {
      const tracks = await patiently(
        () => this.ask(stretch.from, stretch.to, asking.signal),
        asking.signal,
        this.againMs,
      );
      if (asking.signal.aborted) return;
      this.tracks = tracks;
      this.loaded = stretch;
    } catch (cause) {
      if (!asking.signal.aborted) this.trouble = cause instanceof Error ? cause.message : String(cause);
    } finally {
      if (this.asking === asking) this.busy = false;
    }
  }
}
