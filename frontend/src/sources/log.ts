/** What the log of an incident says of events, read in the background: its newest part first. */
import { EVENTS, type Logged, loggedIn, newestIn } from "../domain/time/logged";
import type { Incident } from "../domain/types";

/** So many the server looks through at once: about half an hour of two crews, of which few lines come. */
const ENTRIES_A_PAGE = 4000;
/** So much is read for one incident (characters). */
const MOST_CHARACTERS = 8_000_000;
/** Gateways take turns: the newest epoch told so far stands in one of so many entries. */
const LOOKED_BACK = 20;
/** Between two pages the server is left to what is live (ms). */
const PAUSE_MS = 100;

/**
 * Everything said in the log that the timeline marks, page after page.
 *
 * @param id the incident
 * @param lastSeq its newest entry
 * @param clock the incident's
 * @param signal ends it
 * @returns what each page holds, the newest page first; ends early where the log is larger than that
 */
export async function* loggedPages(
  id: string,
  lastSeq: number,
  clock: Incident["clock"],
  signal: AbortSignal,
): AsyncGenerator<readonly Logged[]> {
  let budget = MOST_CHARACTERS;
  for (let end = lastSeq; end > 0 && budget > 0 && !signal.aborted; end -= ENTRIES_A_PAGE) {
    const after = Math.max(0, end - ENTRIES_A_PAGE);
    const page: Logged[] = [];
    for await (const line of lines(id, after, end - after, EVENTS, signal)) {
      budget -= line.length;
      page.push(loggedIn(line, clock));
      if (budget <= 0) return;
    }
    yield page;
    await new Promise((resolve) => setTimeout(resolve, PAUSE_MS));
  }
}

/** The newest epoch (Unix s) that an incident's log tells of up to entry `seq`; undefined where it tells of none. */
export async function newestToldBy(
  id: string,
  seq: number,
  signal: AbortSignal,
): Promise<number | undefined> {
  const after = Math.max(0, seq - LOOKED_BACK);
  let newest = Number.NEGATIVE_INFINITY;
  for await (const line of lines(id, after, seq - after, [], signal))
    newest = Math.max(newest, newestIn(line));
  return Number.isFinite(newest) ? newest : undefined;
}

/** The lines as they come; who stops reading stops the transfer. */
async function* lines(
  id: string,
  after: number,
  limit: number,
  kinds: readonly string[],
  signal: AbortSignal,
): AsyncGenerator<string> {
  const query = new URLSearchParams({ after: String(after), limit: String(limit) });
  for (const kind of kinds) query.append("kind", kind);
  const answer = await fetch(`/api/v1/incidents/${encodeURIComponent(id)}/log?${query}`, { signal });
  const reader = answer.ok ? answer.body?.pipeThrough(new TextDecoderStream()).getReader() : undefined;
  if (reader === undefined) return;
  let rest = "";
  try {
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      const whole = (rest + part.value).split("\n");
      rest = whole.pop() ?? "";
      yield* whole;
    }
  } finally {
    await reader.cancel();
  }
}
