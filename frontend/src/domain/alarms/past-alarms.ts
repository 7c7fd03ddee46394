/** Alarms of the past, out of what the log says of them: what was raised, when. */

import type { LoggedAlarm } from "../time/logged";
import type { FrameAlarm } from "../types";
import { alarmKey, isCall } from "./alarms";

/** Units repeat an alarm while it sounds: a raise so soon after the last one is the same alarm (s). */
const REPEAT_S = 30;
/** A unit may say something new each time it repeats itself: the first words and the newest are kept. */
const TEXTS_KEPT = 8;
/** Of calls heard: what comes again by another way is known by its epoch. */
const EPOCHS_KEPT = 64;

/** Of everything said of alarms, in whatever order it was read: the alarms, as they were raised. */
export function raisedOf(said: readonly LoggedAlarm[]): FrameAlarm[] {
  const stories = new Map<string, Story>();
  for (const { seq: _, ...one } of [...said].sort((a, b) => a.seq - b.seq)) {
    const known = stories.get(alarmKey(one));
    if (known === undefined) stories.set(alarmKey(one), new Story(one));
    else known.hear(one);
  }
  return [...stories.values()].flatMap(({ raised }) => raised).sort((a, b) => a.t - b.t);
}

/**
 * One alarm of one node, as the server follows it (`backend/tracking/alarms.py`): both are held to the stories
 * in `tests/backend/tracking/alarm_stories.json`, so that the timeline marks what was shown.
 */
class Story {
  /** Each time that it was raised. */
  readonly raised: FrameAlarm[] = [];
  private readonly kind: FrameAlarm["alarm"];
  private state: FrameAlarm["state"];
  private acknowledged: boolean;
  private t: number;
  /** When it was last raised, or raised again; null: an answer came, but no call yet. */
  private calledT: number | null;
  private texts: string[] = [];
  private heard: number[] = [];

  constructor(first: FrameAlarm) {
    this.kind = first.alarm;
    this.state = first.state;
    this.t = first.t;
    this.acknowledged = first.state === "acknowledged";
    this.calledT = first.state === "raised" ? first.t : null;
    if (first.state === "raised") this.heard.push(first.t);
    // What was cleared before it was heard of was never shown.
    if (first.state !== "cleared") this.raised.push(first);
    this.say(first.text);
  }

  hear(said: FrameAlarm): void {
    if (said.state === "raised") {
      this.call(said);
      return;
    }
    if (said.state === "acknowledged") {
      this.acknowledged = true;
      if (this.state === "cleared") return;
    }
    this.state = said.state;
    this.say(said.text);
  }

  /** Whether it is shown: the unit's own clearing is no answer to its call. */
  private get stands(): boolean {
    if (this.state !== "cleared") return true;
    return isCall(this.kind) && this.calledT !== null && !this.acknowledged;
  }

  private call(said: FrameAlarm): void {
    const lastT = this.calledT ?? this.t;
    const known = this.heard.includes(said.t);
    if (!known) this.heard = [...this.heard, said.t].slice(-EPOCHS_KEPT);
    // Of a unit whose clock was put back since, or that was offline.
    const unheard = !known && this.calledT !== null && said.t < this.t - REPEAT_S;
    if (known || (said.t <= lastT && !unheard)) {
      // The answer came by a quicker way than the call: this is when it was called.
      if (this.calledT === null) {
        this.t = this.calledT = said.t;
        this.raised.splice(-1, 1, said);
        this.say(said.text);
      }
      return;
    }
    const newWords = Boolean(said.text) && !this.texts.includes(said.text ?? "");
    const sounding = !unheard && said.t - lastT <= REPEAT_S;
    const answered = this.state === "acknowledged" && (newWords || !sounding);
    if (this.state === "cleared" || answered) {
      if (!this.stands) this.texts = [];
      this.state = "raised";
      this.acknowledged = false;
      this.t = said.t;
      this.raised.push(said);
    } else if (unheard) {
      return;
    }
    this.calledT = said.t;
    this.say(said.text);
  }

  private say(text: string | null | undefined): void {
    if (!text || this.texts.includes(text)) return;
    this.texts.push(text);
    if (this.texts.length > TEXTS_KEPT) this.texts.splice(1, 1);
  }
}
