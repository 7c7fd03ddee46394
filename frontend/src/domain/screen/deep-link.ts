/** The part of the address after #: which incident, when, who, which storey. */
import type { LevelChoice } from "../fixes/levels";

export interface DeepLink {
  readonly incident: string | null;
  /** A moment of the past (Unix s); null means live. */
  readonly t: number | null;
  readonly node: string | null;
  readonly level: LevelChoice;
}

/** Names nothing: live, on all storeys. */
export const NOTHING: DeepLink = { incident: null, t: null, node: null, level: "all" };

export function parseDeepLink(hash: string): DeepLink {
  const fields = new URLSearchParams(hash.replace(/^#/, ""));
  const level = fields.get("level");
  return {
    incident: fields.get("incident") || null,
    t: finite(fields.get("t")),
    node: fields.get("node") || null,
    level: level !== null && /^-?\d+$/.test(level) ? Number(level) : "all",
  };
}

/** "#incident=i1&t=1763712345.0&node=ff1&level=1", without the parts that say nothing. */
export function formatDeepLink(link: DeepLink): string {
  const fields = new URLSearchParams();
  if (link.incident !== null) fields.set("incident", link.incident);
  if (link.t !== null) fields.set("t", link.t.toFixed(1));
  if (link.node !== null) fields.set("node", link.node);
  if (link.level !== "all") fields.set("level", String(link.level));
  const text = fields.toString();
  return text === "" ? "" : `#${text}`;
}

/** Whether going from one to the other is a step that one may want to take back: to another incident, to a card. */
export function isStep(before: DeepLink, after: DeepLink): boolean {
  if (before.incident !== after.incident) return before.incident !== null;
  return before.node === null && after.node !== null;
}

/** Takes `token=` out of a hash: the token, and the hash without it. */
export function takeToken(hash: string): { token: string | null; rest: string } {
  const fields = new URLSearchParams(hash.replace(/^#/, ""));
  const token = fields.get("token");
  fields.delete("token");
  const rest = fields.toString();
  return { token: token || null, rest: rest === "" ? "" : `#${rest}` };
}

function finite(text: string | null): number | null {
  if (text === null || text.trim() === "") return null;
  const value = Number(text);
  return Number.isFinite(value) ? value : null;
}
