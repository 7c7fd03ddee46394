/** The page's address names what is shown; the browser's way back leads through it instead of off the screen. */
import { type DeepLink, formatDeepLink, isStep, parseDeepLink } from "../domain/screen/deep-link";

/** The parts of a browser's window that this needs. */
export interface Browser {
  readonly location: Pick<Location, "hash" | "pathname">;
  readonly history: Pick<History, "pushState" | "replaceState">;
}

/** Marks what this screen has written, in contrast to what a person has. */
const OURS = "firethread";

export class Address {
  private written: DeepLink | null = null;
  /** What is shown next was sought in the browser's history: it is no step further. */
  private travelled = false;

  constructor(private readonly browser: Browser) {}

  /** Names what is shown; who goes back comes to what was shown before the last step. */
  write(shown: DeepLink): void {
    const url = formatDeepLink(shown) || this.browser.location.pathname;
    if (this.written !== null && !this.travelled && isStep(this.written, shown)) {
      this.browser.history.pushState(OURS, "", url);
    } else this.browser.history.replaceState(OURS, "", url);
    this.travelled = false;
    this.written = shown;
  }

  /**
   * The browser has gone to an address, with what was kept of it.
   *
   * @returns what to show: of the incident that is shown already only whom, as it is no reason to leave a storey or
   *   a moment; all that a person has written
   */
  read(kept: unknown): DeepLink {
    const link = parseDeepLink(this.browser.location.hash);
    const here = this.written;
    this.travelled = true;
    if (kept !== OURS || here === null || link.incident !== here.incident) return link;
    return { ...here, node: link.node };
  }
}
