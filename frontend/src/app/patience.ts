/** Waiting for sums over a whole log, which the server goes on with after it has answered that they take long. */
import { RequestFailed } from "../sources/api";

/** Whoever asks again joins the sum that is under way (ms). */
export const AGAIN_MS = 3000;
const TOO_SLOW = 504;

/**
 * Asks again until the sum is done.
 *
 * @param ask asks once; the same each time, as another question begins another sum
 * @param signal ends the waiting
 * @throws what `ask` throws, but for the answer that it takes long
 */
export async function patiently<T>(
  ask: () => Promise<T>,
  signal: AbortSignal,
  againMs = AGAIN_MS,
): Promise<T> {
  for (;;) {
    try {
      return await ask();
    } catch (cause) {
      if (signal.aborted || !(cause instanceof RequestFailed && cause.status === TOO_SLOW)) throw cause;
    }
    await new Promise((resolve) => setTimeout(resolve, againMs));
    signal.throwIfAborted();
  }
}
