/** How long to wait before connecting again. */

const FIRST_MS = 300;
const LONGEST_MS = 8000;

/**
 * Exponential with jitter between half and the whole of it, so that the screens of a command post
 * do not all come back in the same moment.
 *
 * @param attempt attempts that have failed so far, from 0
 * @param random a number in [0, 1)
 */
export function backoffMs(attempt: number, random: number): number {
  const ceiling = Math.min(LONGEST_MS, FIRST_MS * 2 ** Math.min(attempt, 16));
  return ceiling * (0.5 + random / 2);
}
