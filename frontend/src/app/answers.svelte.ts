/** What a person answers to alarms: acknowledged, cleared; and whether the server has it. */
import { alarmKey } from "../domain/alarms/alarms";
import type { FrameAlarm } from "../domain/types";

export type Post = (batch: string, alarm: FrameAlarm, state: FrameAlarm["state"]) => Promise<void>;

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

  /** Send one; whether it has arrived. */
  async say(alarm: FrameAlarm, state: FrameAlarm["state"]): Promise<boolean> {
    this.busy = true;
    const word = `${alarmKey(alarm)} ${alarm.t} ${state}`;
    const batch = this.unsent.get(word) ?? this.freshName();
    this.unsent.set(word, batch);
    try {
      await this.post(batch, alarm, state);
      this.unsent.delete(word);
      this.refused = null;
      return true;
    } catch (cause) {
      this.refused = `Not sent: ${cause instanceof Error ? cause.message : cause} Press again.`;
      return false;
    } finally {
      this.busy = false;
    }
  }
}
