/** The marks on the timeline: what has been seen, and what the record tells of the time before. */
import { type LoggedAlarm, raisedOf } from "../domain/past-alarms";
import { dropMarks, type Mark, withAlarmMarks } from "../domain/timeline";
import type { FrameAlarm, Track } from "../domain/types";
import { loggedAlarms } from "../sources/log";

export class Marks {
  list = $state.raw<readonly Mark[]>([]);
  private reading = new AbortController();

  /** @param name gives the spoken name of a node */
  constructor(private readonly name: (node: string) => string) {}

  clear(): void {
    this.reading.abort();
    this.list = [];
  }

  alarms(raised: readonly FrameAlarm[]): void {
    this.list = withAlarmMarks(this.list, raised, this.name);
  }

  drops(tracks: readonly Track[], breadcrumbs: ReadonlySet<string>): void {
    this.list = [...this.list, ...dropMarks(tracks, breadcrumbs)].sort((a, b) => a.t - b.t);
  }

  /** Reads the alarms of the past out of the log of an incident; what cannot be read has no marks. */
  async readPast(id: string, lastSeq: number): Promise<void> {
    this.reading.abort();
    const reading = new AbortController();
    this.reading = reading;
    const said: LoggedAlarm[] = [];
    try {
      for await (const page of loggedAlarms(id, lastSeq, reading.signal)) {
        if (reading.signal.aborted) return;
        said.push(...page);
      }
    } catch {
      // The log is not the way by which a commander hears of a lost connection.
    }
    if (!reading.signal.aborted) this.alarms(raisedOf(said));
  }
}
