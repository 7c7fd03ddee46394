/** Whether what is shown is now, and how the screen says so: live is what is heard of an open incident of today. */

export type Presence = "live" | "recorded" | "replay" | "closed" | "unheard";

export interface Looking {
  readonly replay: boolean;
  readonly closed: boolean;
  /** Its time goes on with its readings only: an import, an exercise. No age tells that nothing comes any more. */
  readonly recorded: boolean;
  /** There is a picture of now, and the connection by which it came is not lost. */
  readonly heard: boolean;
}

export function presenceOf({ replay, closed, recorded, heard }: Looking): Presence {
  if (replay) return "replay";
  // A closed incident stays as it was, whether its server is heard or not.
  if (closed) return "closed";
  if (!heard) return "unheard";
  return recorded ? "recorded" : "live";
}

const BADGES: Record<Presence, string> = {
  live: "LIVE",
  recorded: "RECORDED",
  replay: "REPLAY",
  closed: "CLOSED",
  unheard: "NOT LIVE",
};

/** What stands beside the clock. */
export function badgeOf(presence: Presence): string {
  return BADGES[presence];
}

/** What is shown is how it was: in the past, at the end, or, where time stands until the next reading, at the last. */
export function isOfThen(presence: Presence): boolean {
  return presence === "closed" || presence === "recorded" || presence === "replay";
}

/** How many are live, where that is so now. */
export function liveWords(count: number, presence: Presence): string {
  return isOfThen(presence) ? `${count} ${count === 1 ? "was" : "were"} live` : `${count} live`;
}

/** What the button says that leads to the newest picture, or tells that it is shown already. */
export function newestButton(
  presence: Presence,
  { closed, recorded }: Pick<Looking, "closed" | "recorded">,
): string {
  if (presence === "replay") return closed || recorded ? "Back to the end" : "Back to live";
  return { live: "Live", recorded: "Recorded", closed: "Closed", unheard: "Not live" }[presence];
}
