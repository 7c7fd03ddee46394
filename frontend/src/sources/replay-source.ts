import { ANSWERED_WITHIN_MS, answers, isOverdue, type Sought } from "../domain/time/seeking";
import { ReconnectingSource, socketAddress, type Told } from "./reconnecting";

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
  /** When it was last told where to go, on the local monotonic clock (ms). */
  private toldMs = 0;

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
    this.tell();
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

  /**
   * A picture begins with a whole frame: a change to another one, laid over what is shown, would show neither.
   * A server that goes on without one is asked again, or nothing would ever be shown.
   */
  protected override concerns(type: Told["type"], t: number): boolean {
    this.opening &&= type !== "frame" || !this.isAnswer(type, t);
    if (this.opening && performance.now() - this.toldMs > ANSWERED_WITHIN_MS) this.tell();
    return !this.opening;
  }

  protected override time(type: Told["type"], t: number): number | null {
    if (!this.isAnswer(type, t)) return null;
    this.sought = null;
    this.at.t = t;
    return t;
  }

  private tell(): void {
    this.toldMs = performance.now();
    this.send({ seek: this.at.t });
  }

  /** A heartbeat is no answer to a seek: it tells where the replay is, and the picture may be of where it was. */
  private isAnswer(type: Told["type"], t: number): boolean {
    if (this.sought === null) return true;
    const localMs = performance.now();
    return type === "heartbeat"
      ? isOverdue(this.sought, localMs)
      : answers(this.sought, t, localMs, this.at.speed);
  }
}
