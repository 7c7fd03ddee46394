/** Where a picture comes from: the live incident or its record, behind one interface. */
import type { DeltaMessage, FrameMessage, HeartbeatMessage } from "../domain/types";

/** The state of the way to the server. Times are of the local monotonic clock (ms). */
export interface LinkState {
  readonly link: "connecting" | "open" | "lost" | "closed";
  /** When the last word came; null before the first. */
  readonly lastWordMs: number | null;
  /** Attempts to connect since the link was last open. */
  readonly attempts: number;
}

/** Each message comes with the incident time that it tells (Unix s), or null: it was on its way when another
 * was sought, which a picture will answer. */
export interface Listener {
  frame(message: FrameMessage, t: number | null): void;
  delta(message: DeltaMessage, t: number | null): void;
  heartbeat(message: HeartbeatMessage, t: number | null): void;
  state(state: LinkState): void;
}

export interface Source {
  /** Hears everything from now on, the link's state at once; returns how to stop. */
  subscribe(listener: Listener): () => void;
  close(): void;
}

export const NOT_CONNECTED: LinkState = { link: "connecting", lastWordMs: null, attempts: 0 };
