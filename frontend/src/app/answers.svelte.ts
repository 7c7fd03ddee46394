/** What a person answers to alarms: acknowledged, cleared; and whether the server has it. */
import { alarmKey } from "../domain/alarms/alarms";
import type { FrameAlarm } from "../domain/types";

/** Sends one to an incident, under a name; gives the entry of the log in which it is. */
export type Post = (
  incident: string,
  batch: string,
  alarm: FrameAlarm,
  state: FrameAlarm["state"],
) => Promise<number>;

export class Answers {
  /** One is on its way. */
  busy = $state(false);
  /** Why the last one could not be sent. */
  refused = $state<string | null>(null);
  /** A word that may not have arrived is sent again under the same name: the log takes it once. */
  private readonly unsent = new Map<string, string>();

  constructor(
    private readonly post: Post,
    private readonly freshName: () => string,
  ) {}

  /** Send one to an incident; the entry of the log in which it is, or null: it may not have arrived. */
  async say(incident: string, alarm: FrameAlarm, state: FrameAlarm["state"]): Promise<number | null> {
    this.busy = true;
    const word = `${incident} ${alarmKey(alarm)} ${alarm.t} ${state}`;
    const batch = this.unsent.get(word) ?? this.freshName();
    this.unsent.set(word, batch);
    try {
      const seq = await this.post(incident, batch, alarm, state);
      this.unsent.delete(word);
      this.refused = null;
      return seq;
    } catch (cause) {
      this.refused = `Not sent: ${cause instanceof Error ? cause.message : cause} Press again.`;
      return null;
    } finally {
      this.busy = false;
    }
  }
}
