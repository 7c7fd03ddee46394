/** The alarm's sound, made here: no file, no network. Browsers allow it only after a person has acted. */

const HIGH_HZ = 960;
const LOW_HZ = 770;
const TONE_S = 0.45;
const REPEAT_MS = 2400;

export class AlarmSound {
  private context: AudioContext | null = null;
  private repeating: ReturnType<typeof setInterval> | undefined;

  /** @param changed told whether it may sound, also when the system takes the sound away or gives it back */
  constructor(private readonly changed: (enabled: boolean) => void) {}

  /** Whether the browser lets it sound. */
  get enabled(): boolean {
    return this.context?.state === "running";
  }

  /** Asks the browser to let it sound; works only within a person's act. */
  async enable(): Promise<void> {
    this.context ??= new AudioContext();
    // A call, a lock screen, a lost loudspeaker: the system stops it, and nobody may believe that it sounds.
    this.context.onstatechange = () => this.changed(this.enabled);
    await this.context.resume();
    this.changed(this.enabled);
  }

  /** Sounds until told otherwise. */
  set sounding(on: boolean) {
    clearInterval(this.repeating);
    this.repeating = undefined;
    if (!on) return;
    this.once();
    this.repeating = setInterval(() => this.once(), REPEAT_MS);
  }

  private once(): void {
    const context = this.context;
    if (context === null || !this.enabled) return;
    const volume = context.createGain();
    volume.gain.value = 0.25;
    volume.connect(context.destination);
    [HIGH_HZ, LOW_HZ].forEach((frequency, index) => {
      const tone = context.createOscillator();
      tone.type = "square";
      tone.frequency.value = frequency;
      tone.connect(volume);
      tone.start(context.currentTime + index * TONE_S);
      tone.stop(context.currentTime + (index + 1) * TONE_S);
    });
  }
}
