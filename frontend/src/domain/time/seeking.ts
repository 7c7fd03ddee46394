/** Whether a message of a replay is of the moment that was asked for, or was on its way before. */

export interface Sought {
  /** The moment asked for (Unix s). */
  readonly t: number;
  /** Local monotonic clock then (ms). */
  readonly localMs: number;
}

/** The server answers at once: what comes later is believed, whatever it is of. */
export const ANSWERED_WITHIN_MS = 2000;
const ROUNDING_S = 1e-3;

/** Whether an answer should have come by `localMs` (local monotonic clock, ms). */
export function isOverdue(sought: Sought, localMs: number): boolean {
  return localMs - sought.localMs > ANSWERED_WITHIN_MS;
}

/**
 * Whether a message has been made after a seek. One made before would put the clock back: of three quick
 * steps the last two would begin where the first one did.
 *
 * @param sought what was asked for
 * @param t what the message is of (Unix s)
 * @param localMs local monotonic clock now (ms)
 * @param speed incident seconds per second, as far as it may go on
 */
export function answers(sought: Sought, t: number, localMs: number, speed: number): boolean {
  const waitedMs = localMs - sought.localMs;
  const after = t - sought.t;
  if (isOverdue(sought, localMs)) return true;
  return after >= -ROUNDING_S && after <= (speed * waitedMs) / 1000 + ROUNDING_S;
}
