/**
 * Whether what lies under a finger is what lay there when it came down. A second tap of a hand in a glove, or one
 * meant for a button that another screen has just changed, must clear no call, nor acknowledge the next one.
 */
export const SETTLES_MS = 1000;

export class Settled {
  yes = $state(true);
  private before: readonly string[] = [];
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** What there is to be pressed, from the top: what comes below moves nothing. */
  sees(shown: readonly string[]): void {
    const moved = this.before.some((one, at) => one !== shown[at]);
    this.before = shown;
    if (!moved) return;
    this.yes = false;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.yes = true;
    }, SETTLES_MS);
  }
}
