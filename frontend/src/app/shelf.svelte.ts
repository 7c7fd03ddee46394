/** What a person has seen and put aside for a while: it is said more quietly, and loudly again after that. */

/** At the end of a wear some 20 bar are breathed in it (ms). */
export const SHELVED_MS = 180_000;

export class Shelf {
  private seen = $state.raw<ReadonlyMap<string, number>>(new Map());

  /** @param localMs the local monotonic clock (ms) */
  put(what: readonly string[], localMs: number): void {
    this.seen = new Map([...this.seen, ...what.map((one): [string, number] => [one, localMs])]);
  }

  has(what: string, localMs: number): boolean {
    const putMs = this.seen.get(what);
    return putMs !== undefined && localMs - putMs < SHELVED_MS;
  }

  /** What is not there any more is news when it comes again. */
  keep(what: ReadonlySet<string>): void {
    if ([...this.seen.keys()].every((one) => what.has(one))) return;
    this.seen = new Map([...this.seen].filter(([one]) => what.has(one)));
  }
}
