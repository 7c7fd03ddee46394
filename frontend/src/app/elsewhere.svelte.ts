/**
 * Looks into the incidents that are not shown: a call for help must reach whoever looks at another one.
 *
 * It asks for the list, and for the picture of those whose log has grown. Sockets would bring every step of
 * everybody there, over a link that the incident on the screen needs; so a weak link only makes the looks
 * rarer, and how old they are is said.
 */
import { type Glimpse, glimpseOf, type Shown, toLookInto } from "../domain/alarms/elsewhere";
import type { Incident } from "../domain/types";

const LOOK_EVERY_MS = 1000;
/** As with the live link, silence longer than this is said. */
const SILENCE_MS = 5000;

export interface ElsewhereSource {
  /** The incidents that are not closed. */
  active(): Promise<readonly Incident[]>;
  /** What is known of one now. */
  frame(incident: string): Promise<Shown>;
}

export interface ElsewhereOwner {
  /** What is shown needs no look. */
  readonly incident: Incident | null;
}

export interface ElsewhereDoor {
  readonly signInNeeded: boolean;
  failQuietly(cause: unknown): void;
}

export class Elsewhere {
  active = $state.raw<readonly Incident[]>([]);
  glimpses = $state.raw<ReadonlyMap<string, Glimpse>>(new Map());
  /** Local monotonic clock when everything there was to see had been seen (ms). */
  private seenMs = $state(performance.now());
  /** What was forgotten since the look that is under way began. */
  private readonly forgotten = new Set<string>();

  constructor(
    private readonly source: ElsewhereSource,
    private readonly owner: ElsewhereOwner,
    private readonly door: ElsewhereDoor,
  ) {}

  /** Looks again and again. */
  async begin(): Promise<never> {
    for (;;) {
      if (!this.door.signInNeeded) await this.look().catch((cause) => this.door.failQuietly(cause));
      await new Promise((resolve) => setTimeout(resolve, LOOK_EVERY_MS));
    }
  }

  /**
   * Looks once. What could be seen is kept, whatever else could not.
   *
   * @throws the first refusal
   */
  async look(): Promise<void> {
    this.forgotten.clear();
    const active = await this.source.active();
    const shown = this.owner.incident?.id ?? null;
    const looks = await Promise.allSettled(
      toLookInto(active, shown, this.glimpses).map(async (incident) => {
        const frame = await this.source.frame(incident.id);
        return [incident.id, glimpseOf(incident, frame, performance.now())] as const;
      }),
    );
    // Of what is shown, the live link tells; what was seen before is old when another one is shown.
    const known = [...this.glimpses].filter(([id]) => id !== shown && active.some((one) => one.id === id));
    const seen = looks
      .flatMap((look) => (look.status === "fulfilled" ? [look.value] : []))
      .filter(([id]) => !this.forgotten.has(id));
    this.glimpses = new Map([...known, ...seen]);
    this.active = active;
    const refused = looks.find((look) => look.status === "rejected");
    if (refused !== undefined) throw refused.reason;
    this.seenMs = performance.now();
  }

  /** The commander was there, and may have answered: what was seen before is no longer so. */
  forget(id: string): void {
    this.forgotten.add(id);
    this.glimpses = new Map([...this.glimpses].filter(([known]) => known !== id));
  }

  /** For how long nothing has been seen of the other incidents (s); null: not for long, or there are none. */
  silentS(localMs: number): number | null {
    const others = this.active.some(({ id }) => id !== this.owner.incident?.id);
    const silentMs = localMs - this.seenMs;
    return others && silentMs > SILENCE_MS ? silentMs / 1000 : null;
  }
}
