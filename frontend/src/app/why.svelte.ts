/** Asking why a fix is where it is: what has been asked, and what came of it. */
import type { Advice, Evidence } from "../domain/types";

export interface WhySource {
  evidence(): Promise<Evidence>;
  /** Null where advice would be idle: nothing can be done about the past. */
  advice(): Promise<Advice> | null;
}

export class Why {
  open = $state(false);
  /** The evidence is on its way. */
  busy = $state(false);
  /** Why there is no evidence. */
  trouble = $state<string | null>(null);
  evidence = $state.raw<Evidence | null>(null);
  advice = $state.raw<Advice | null>(null);
  /** Why there is no advice, where there should be. */
  noAdvice = $state<string | null>(null);
  /** Answers to questions before this one are too late. */
  private question = 0;

  constructor(private readonly source: WhySource) {}

  async toggle(): Promise<void> {
    if (this.open) this.close();
    else await this.ask();
  }

  close(): void {
    this.open = this.busy = false;
    this.question += 1;
  }

  async ask(): Promise<void> {
    this.question += 1;
    const asked = this.question;
    this.open = this.busy = true;
    this.trouble = this.noAdvice = this.evidence = this.advice = null;
    try {
      const evidence = await this.source.evidence();
      if (asked !== this.question) return;
      this.evidence = evidence;
      this.busy = false;
    } catch (cause) {
      if (asked !== this.question) return;
      this.trouble = messageOf(cause);
      this.busy = false;
      return;
    }
    // After the evidence: the server does one at a time, and the evidence is what was asked for.
    try {
      const advice = await this.source.advice();
      if (asked === this.question) this.advice = advice;
    } catch (cause) {
      if (asked === this.question) this.noAdvice = messageOf(cause);
    }
  }
}

function messageOf(cause: unknown): string {
  return cause instanceof Error ? cause.message : String(cause);
}
