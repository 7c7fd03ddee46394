/** The marks on the timeline: what has been seen, and what the record tells of the time before. */

import { raisedOf } from "../domain/alarms/past-alarms";
import { dropsOf, type LoggedAlarm, type LoggedDrop, newBreadcrumbs } from "../domain/time/logged";
import { setMarks } from "../domain/time/stretches";
import { type Mark, withAlarmMarks, withDropMarks, withSetMarks } from "../domain/time/timeline";
import type { DeltaMessage, FrameAlarm, FrameMessage, Incident } from "../domain/types";
import { loggedPages, newestToldBy } from "../sources/log";

export class Marks {
  list = $state.raw<readonly Mark[]>([]);
  private reading = new AbortController();
  /** The past of the incident is read, or has been. */
  private readsPast = false;
  /** Breadcrumbs that have been in the picture. */
  private readonly lying = new Set<string>();
  /** The newest epoch told up to the log entries after which something was set (Unix s). */
  private readonly whenTold = new Map<number, number>();

  /** @param name gives the spoken name of a node */
  constructor(private readonly name: (node: string) => string) {}

  clear(): void {
    this.reading.abort();
    this.readsPast = false;
    this.lying.clear();
    this.whenTold.clear();
    this.list = [];
  }

  /** A live picture has changed. */
  seen(message: FrameMessage | DeltaMessage): void {
    this.alarms(message.alarms);
    const fresh = newBreadcrumbs(message.nodes, this.lying);
    for (const { node } of fresh) this.lying.add(node);
    // Those of a whole frame may have lain there for long: of them the log tells.
    if (message.type === "delta") this.drops(fresh);
  }

  /** The incident is as it was told of now. */
  told(incident: Incident): void {
    this.list = withSetMarks(this.list, setMarks(incident, this.whenTold));
    // Of one that has just been opened the present comes first.
    if (this.readsPast) this.findTimes(incident, this.reading.signal).catch(quietly);
  }

  /** Reads the past out of the log of an incident; what cannot be read has no marks. */
  async readPast(incident: Incident, lastSeq: number): Promise<void> {
    const { id, clock } = incident;
    this.reading.abort();
    const reading = new AbortController();
    this.reading = reading;
    this.readsPast = true;
    const alarms: LoggedAlarm[] = [];
    const drops: LoggedDrop[] = [];
    try {
      await this.findTimes(incident, reading.signal);
      for await (const page of loggedPages(id, lastSeq, clock, reading.signal)) {
        if (reading.signal.aborted) return;
        alarms.push(...page.flatMap((line) => line.alarms));
        drops.push(...page.flatMap((line) => line.drops));
        this.drops(drops.filter(({ dropped }) => dropped));
      }
    } catch {
      quietly();
    }
    if (reading.signal.aborted) return;
    this.alarms(raisedOf(alarms));
    this.drops(dropsOf(drops));
  }

  /** Finds in the log when something was set, where readings are the clock, and marks it there. */
  private async findTimes(incident: Incident, signal: AbortSignal): Promise<void> {
    if (incident.clock !== "recorded") return;
    for (const { after_seq } of incident.stretches.slice(1)) {
      if (this.whenTold.has(after_seq)) continue;
      const t = await newestToldBy(incident.id, after_seq, signal);
      if (signal.aborted) return;
      if (t !== undefined) this.whenTold.set(after_seq, t);
    }
    this.list = withSetMarks(this.list, setMarks(incident, this.whenTold));
  }

  private alarms(raised: readonly FrameAlarm[]): void {
    this.list = withAlarmMarks(this.list, raised, this.name);
  }

  private drops(dropped: readonly { node: string; t: number }[]): void {
    this.list = withDropMarks(this.list, dropped, this.name);
  }
}

/** The log is not the way by which a commander hears of a lost connection. */
function quietly(): void {}
