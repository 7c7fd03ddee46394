/** Asks again for what no message tells: the first incident while there is none, then how it stands with this one. */
import type { Incident } from "../domain/types";
import * as api from "../sources/api";

const LOOK_EVERY_MS = 3000;
const RENEW_EVERY_MS = 10_000;

export interface AskingOwner {
  readonly incident: Incident | null;
  renewed(incident: Incident): void;
}

export interface AskingDoor {
  readonly signInNeeded: boolean;
  /** The address names an incident that there is not: asking again would not bring it. */
  readonly deadLink: boolean;
  /** Looks for the first incident. */
  begin(): Promise<void>;
  failQuietly(cause: unknown): void;
}

export class Asking {
  private askedMs = Number.NEGATIVE_INFINITY;
  /** The newest entry of the log at the last sign of life. */
  private heardSeq = -1;
  private quiet = false;

  constructor(
    private readonly owner: AskingOwner,
    private readonly door: AskingDoor,
  ) {
    setInterval(() => {
      if (door.signInNeeded) return;
      if (owner.incident === null) {
        if (!door.deadLink) void door.begin();
      } else if (performance.now() - this.askedMs >= RENEW_EVERY_MS) void this.renew(owner.incident.id);
    }, LOOK_EVERY_MS);
  }

  /** Nothing more comes of a closed incident: when it has just become quiet, it may have been closed. */
  heartbeat(seq: number): void {
    const { incident } = this.owner;
    const quiet = seq === this.heardSeq;
    if (quiet && !this.quiet && incident?.state === "active") void this.renew(incident.id);
    this.heardSeq = seq;
    this.quiet = quiet;
  }

  private async renew(id: string): Promise<void> {
    this.askedMs = performance.now();
    try {
      const newest = await api.incident(id);
      if (this.owner.incident?.id === id) this.owner.renewed(newest);
    } catch (cause) {
      this.door.failQuietly(cause);
    }
  }
}
