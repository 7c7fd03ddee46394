/** The way to an incident: by a link, from the list, to a call for help elsewhere, and back from there. */

import type { CallElsewhere } from "../domain/alarms/elsewhere";
import { type DeepLink, NOTHING } from "../domain/screen/deep-link";
import type { Incident } from "../domain/types";
import * as api from "../sources/api";

export interface DoorOwner {
  readonly incident: Incident | null;
  /** What the address is to name: what is shown, or is to be. */
  readonly shown: DeepLink;
  /** The moment of the past that is looked at (Unix s); null: none. */
  readonly pastT: number | null;
  /** That the server cannot be reached is said over everything already. */
  readonly lossIsSaid: boolean;
  open(incident: Incident, link: DeepLink): void;
  renewed(incident: Incident): void;
}

/** What was shown when a call for help led elsewhere. */
export interface Left {
  readonly name: string;
  readonly link: DeepLink;
}

export class Door {
  incidents = $state.raw<readonly Incident[]>([]);
  signInNeeded = $state(false);
  trouble = $state<string | null>(null);
  /** The way back; null where no call has led away. */
  left = $state.raw<Left | null>(null);
  /** Only a person can tell what to show instead. */
  deadLink = false;
  /** An attempt to load what the address names is under way. */
  private beginning = false;
  /** How often somebody has asked for an incident: what was asked for before comes too late. */
  private wishes = 0;
  /** How often the list was asked for. */
  private looks = 0;

  constructor(private readonly owner: DoorOwner) {}

  /** Loads the list of incidents and opens the one that the address names, else the newest active one. */
  async begin(): Promise<void> {
    if (this.beginning) return;
    this.beginning = true;
    const link = this.owner.shown;
    const wishes = this.wishes;
    try {
      await this.refresh();
      this.signInNeeded = false;
      if (wishes !== this.wishes) return;
      await this.follow({ ...link, incident: link.incident ?? this.incidents[0]?.id ?? null });
    } catch (cause) {
      this.fail(cause);
    } finally {
      this.beginning = false;
    }
  }

  /** Shows what a link names; nothing new where it names no incident. */
  async follow(link: DeepLink, left: Left | null = null): Promise<void> {
    if (link.incident === null) return;
    this.wishes += 1;
    const wish = this.wishes;
    try {
      const incident = await api.incident(link.incident);
      if (wish !== this.wishes) return;
      this.trouble = null;
      this.left = left;
      this.incidents = withShown(this.incidents, incident);
      this.owner.open(incident, link);
    } catch (cause) {
      if (wish !== this.wishes) return;
      this.deadLink = cause instanceof api.RequestFailed && cause.status === 404;
      if (this.deadLink)
        this.trouble = `This link's incident (${link.incident}) is not on this server: choose one above.`;
      else this.fail(cause);
    }
  }

  /** Shows an incident as it is now, on all storeys. */
  choose(id: string): Promise<void> {
    return this.follow({ ...NOTHING, incident: id });
  }

  /** Shows who calls for help in another incident, and keeps the way back to what was shown before. */
  goToCall({ incident, call }: CallElsewhere): Promise<void> {
    const { incident: here, shown, pastT } = this.owner;
    // Of several calls, one after the other, it is still the first incident that was left.
    const left = this.left ?? (here === null ? null : { name: here.name, link: { ...shown, t: pastT } });
    const there: DeepLink = { ...NOTHING, incident: incident.id, node: call.alarm.node };
    return this.follow(there, left?.link.incident === incident.id ? null : left);
  }

  async goBack(): Promise<void> {
    if (this.left !== null) await this.follow(this.left.link);
  }

  /** Reads the list again; an answer that comes after a newer one was asked for tells nothing. */
  async refresh(): Promise<void> {
    this.looks += 1;
    const look = this.looks;
    const list = await api.incidents().catch((cause) => {
      if (look === this.looks) throw cause;
      return null;
    });
    if (list === null || look !== this.looks) return;
    this.incidents = withShown(list, this.owner.incident);
    const current = list.find(({ id }) => id === this.owner.incident?.id);
    if (current) this.owner.renewed(current);
    this.trouble = null;
  }

  fail(cause: unknown): void {
    const status = cause instanceof api.RequestFailed ? cause.status : null;
    if (status === 401) this.signInNeeded = true;
    else if (status !== 0 || !this.owner.lossIsSaid)
      this.trouble = cause instanceof Error ? cause.message : String(cause);
  }

  /** For what is asked again and again: whether the server can be reached, the screen tells in its place. */
  failQuietly(cause: unknown): void {
    if (cause instanceof api.RequestFailed && cause.status === 401) this.fail(cause);
  }
}

/** A list may be older than the incident that is shown: without it there, nothing would say which one that is. */
function withShown(list: readonly Incident[], shown: Incident | null): readonly Incident[] {
  return shown === null || list.some(({ id }) => id === shown.id) ? list : [shown, ...list];
}
