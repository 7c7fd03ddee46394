import { answers, type Sought } from "../domain/seeking";
import { ReconnectingSource, socketAddress } from "./reconnecting";

export interface ReplayFrom {
  /** First moment that can be sought (Unix s). */
  readonly begin: number;
  /** Where to begin (Unix s). */
  readonly at: number;
  readonly to: number;
  readonly speed: number;
  readonly paused: boolean;
}

/** The incident as it was, played from its log; it can be sought, paused and sped up. */
export class ReplaySource extends ReconnectingSource {
  private readonly at: { t: number; speed: number; paused: boolean };
  /** What no message has answered yet. */
  private sought: Sought | null = null;
  /** A server begins with the beginning, before it has heard what is sought: nobody has asked for that. */
  private opening = false;

  constructor(incident: string, { begin, at, to, speed, paused }: ReplayFrom) {
    super(() => {
      const query = new URLSearchParams({ from: String(begin), to: String(to) });
      return socketAddress(`/api/v1/incidents/${encodeURIComponent(incident)}/replay?${query}`);
    });
    this.at = { t: at, speed, paused };
  }

  seek(t: number): void {
    this.at.t = t;
    this.sought = { t, localMs: performance.now() };
    this.send({ seek: t });
  }

  setSpeed(speed: number): void {
    this.at.speed = speed;
    this.send({ speed });
  }

  setPaused(paused: boolean): void {
    this.at.paused = paused;
    this.send({ pause: paused });
  }

  /** Also after a break the replay goes on where it was. */
  protected override opened(): void {
    this.opening = true;
    this.send({ speed: this.at.speed });
    this.send({ pause: this.at.paused });
    this.seek(this.at.t);
  }

  protected override concerns(t: number): boolean {
    this.opening &&= !this.isAnswer(t);
    return !this.opening;
  }

  protected override time(t: number): number | null {
    if (!this.isAnswer(t)) return null;
    this.sought = null;
    this.at.t = t;
    return t;
  }

  private isAnswer(t: number): boolean {
    return this.sought === null || answers(this.sought, t, performance.now(), this.at.speed);
  }
}
