/** Whether what is shown is now, and how the screen says so: only what is heard of an open incident is live. */

export type Presence = "live" | "replay" | "closed" | "unheard";

export interface Looking {
  readonly replay: boolean;
  readonly closed: boolean;
  /** There is a picture of now, and the connection by which it came is not lost. */
  readonly heard: boolean;
}

export function presenceOf({ replay, closed, heard }: Looking): Presence {
  if (replay) return "replay";
  // A closed incident stays as it was, whether its server is heard or not.
  if (closed) return "closed";
  return heard ? "live" : "unheard";
}

const BADGES: Record<Presence, string> = {
  live: "LIVE",
  replay: "REPLAY",
  closed: "CLOSED",
  unheard: "NOT LIVE",
};

/** What stands beside the clock. */
export function badgeOf(presence: Presence): string {
  return BADGES[presence];
}

/** What the button says that leads to the newest picture, or tells that it is shown already. */
export function newestButton(presence: Presence, closed: boolean): string {
  if (presence === "replay") return closed ? "Back to the end" : "Back to live";
  return { live: "Live", closed: "Closed", unheard: "Not live" }[presence];
}
