/** Whether the device slept: the monotonic clock of a browser may stand still meanwhile, the wall clock goes on. */

/** Clocks that part by more than this have slept, or the wall clock was set: then what is shown is old, or may be (ms). */
export const SLEPT_MS = 2000;

export class Sleep {
  private wallMs: number;
  private monotonicMs: number;

  constructor(wallMs: number, monotonicMs: number) {
    this.wallMs = wallMs;
    this.monotonicMs = monotonicMs;
  }

  /** How long the device slept since this was asked last (ms); 0: it did not. */
  since(wallMs: number, monotonicMs: number): number {
    const sleptMs = wallMs - this.wallMs - (monotonicMs - this.monotonicMs);
    this.wallMs = wallMs;
    this.monotonicMs = monotonicMs;
    return sleptMs > SLEPT_MS ? sleptMs : 0;
  }
}
