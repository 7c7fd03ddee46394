/** Keeps the screen lit: a tablet that has gone dark shows nobody, and its browser sounds no alarm. */

export class Awake {
  private light: WakeLockSentinel | null = null;
  private wanted = false;
  private asking = false;

  /**
   * @param lights the browser's; there are none where the page comes neither over https nor from the device itself
   * @param page it is asked again whenever this is looked at, or touched
   */
  constructor(
    private readonly lights: WakeLock | undefined,
    private readonly page: Pick<Document, "visibilityState" | "addEventListener">,
  ) {
    // The system takes the light away from what is hidden, and when the battery is low; it gives none back by itself.
    page.addEventListener("visibilitychange", () => void this.ask());
    page.addEventListener("pointerdown", () => void this.ask());
  }

  /** Whether the browser can keep the screen lit at all. */
  get possible(): boolean {
    return this.lights !== undefined;
  }

  /** Keeps it lit from now on, or lets it go dark. */
  async keep(lit: boolean): Promise<void> {
    this.wanted = lit;
    await (lit ? this.ask() : this.light?.release());
  }

  private async ask(): Promise<void> {
    const lit = this.light !== null && !this.light.released;
    if (!this.wanted || lit || this.asking || this.lights === undefined) return;
    if (this.page.visibilityState !== "visible") return;
    this.asking = true;
    try {
      this.light = await this.lights.request("screen");
      if (!this.wanted) await this.light.release();
    } catch {
      this.light = null; // refused, as with a battery that is low: the next touch asks again
    } finally {
      this.asking = false;
    }
  }
}
