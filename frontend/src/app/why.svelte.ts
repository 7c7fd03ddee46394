/** Asking why a fix is where it is: what has been asked, since when, and what came of it. */
import type { Advice, Evidence } from "../domain/types";
import { AGAIN_MS, patiently } from "./patience";

export interface WhySource {
  /** The moment that is asked about (Unix s); null: the newest. */
  moment(): number | null;
  evidence(moment: number | null, signal: AbortSignal): Promise<Evidence>;
  /** Not where advice would be idle: nothing can be done about the past. */
  advises(): boolean;
  advice(signal: AbortSignal): Promise<Advice>;
}

/** What the server is working out. */
export type Weighing = "evidence" | "advice";

export class Why {
  open = $state(false);
  /** What is on its way; null: nothing is. */
  weighing = $state<Weighing | null>(null);
  /** When that was asked for, by the local monotonic clock (ms). */
  sinceMs = $state(0);
  /** Why there is no evidence. */
  trouble = $state<string | null>(null);
  evidence = $state.raw<Evidence | null>(null);
  advice = $state.raw<Advice | null>(null);
  /** Why there is no advice, where there should be. */
  noAdvice = $state<string | null>(null);
  /** Answers to the question before this one are too late. */
  private asking = new AbortController();

  constructor(
    private readonly source: WhySource,
    private readonly againMs = AGAIN_MS,
  ) {}

  /** The evidence is on its way. */
  get busy(): boolean {
    return this.weighing === "evidence";
  }

  async toggle(): Promise<void> {
    if (this.open) this.close();
    else await this.ask();
  }

  close(): void {
    this.asking.abort();
    this.open = false;
    this.weighing = null;
  }

  async ask(): Promise<void> {
    this.asking.abort();
    const asking = new AbortController();
    this.asking = asking;
    this.open = true;
    this.trouble = this.noAdvice = this.evidence = this.advice = null;
    // In a replay time goes on; a question about each of its moments would be another sum each time.
    const moment = this.source.moment();
    const evidence = await this.answer("evidence", asking.signal, () =>
      this.source.evidence(moment, asking.signal),
    );
    if (evidence === null) return;
    this.evidence = evidence;
    if (!this.source.advises()) return;
    // After the evidence: the server does one at a time, and the evidence is what was asked for.
    this.advice = await this.answer("advice", asking.signal, () => this.source.advice(asking.signal));
  }

  /** What comes of a question; null where nothing does, or nobody waits for it any more. */
  private async answer<T>(what: Weighing, signal: AbortSignal, ask: () => Promise<T>): Promise<T | null> {
    this.weighing = what;
    this.sinceMs = performance.now();
    try {
      const given = await patiently(ask, signal, this.againMs);
      return signal.aborted ? null : given;
    } catch (cause) {
      if (signal.aborted) return null;
      if (what === "evidence") this.trouble = messageOf(cause);
      else this.noAdvice = messageOf(cause);
      return null;
    } finally {
      if (!signal.aborted) this.weighing = null;
    }
  }
}

function messageOf(cause: unknown): string {
  return cause instanceof Error ? cause.message : String(cause);
}
