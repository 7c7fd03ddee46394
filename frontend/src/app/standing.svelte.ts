/** The alarms that stand: as the pictures list them, and as they were answered here before a picture tells of it. */
import { answered, type StandingAlarms, standingAlarms } from "../domain/alarms/alarms";
import type { FrameAlarm, FrameMessage } from "../domain/types";

/** A person's word on an alarm, and the entry of the log in which it is. */
interface Given {
  readonly alarm: FrameAlarm;
  readonly state: FrameAlarm["state"];
  readonly seq: number;
}

export class Standing {
  list = $state.raw<StandingAlarms>(new Map());
  /** What is in the log, and in no picture yet. */
  private given: readonly Given[] = [];

  /** A picture has come. What it does not have yet is not taken back by it: the log has it. */
  heard({ seq, alarms }: Pick<FrameMessage, "seq" | "alarms">): void {
    this.given = this.given.filter((one) => one.seq > seq);
    this.list = this.given.reduce(withAnswer, standingAlarms(alarms));
  }

  /** A person's word has reached the log, as entry `seq`. */
  answered(alarm: FrameAlarm, state: FrameAlarm["state"], seq: number): void {
    const given = { alarm, state, seq };
    this.given = [...this.given, given];
    this.list = withAnswer(this.list, given);
  }

  /** Another incident is shown. */
  clear(): void {
    this.given = [];
    this.list = new Map();
  }
}

function withAnswer(list: StandingAlarms, { alarm, state }: Given): StandingAlarms {
  return answered(list, alarm, state);
}
