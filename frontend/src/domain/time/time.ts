/** Times as the commander reads them: local, with seconds. */

const CLOCK = new Intl.DateTimeFormat(undefined, {
  hour: "2-digit",
  minute: "2-digit",
  second: "2-digit",
  hourCycle: "h23",
});
const DAY = new Intl.DateTimeFormat(undefined, { day: "numeric", month: "short", year: "numeric" });

/** "21:04:10" of a Unix time in seconds. */
export function clockTime(t: number): string {
  return CLOCK.format(new Date(t * 1000));
}

/** "20 Nov 2025" of a Unix time in seconds. */
export function day(t: number): string {
  return DAY.format(new Date(t * 1000));
}

/** So near to a change of the clocks a time may be taken for one before it, or after (s). */
const NEAR_CHANGE_S = 6 * 3600;

/** "UTC+2" near the hour in which the clocks are changed, which has some times twice; nothing else. */
export function zoneNearChange(t: number): string | null {
  const aheadMin = (at: number) => -new Date(at * 1000).getTimezoneOffset();
  const ahead = aheadMin(t);
  if (aheadMin(t - NEAR_CHANGE_S) === ahead && aheadMin(t + NEAR_CHANGE_S) === ahead) return null;
  const [hours, minutes] = [Math.trunc(Math.abs(ahead) / 60), Math.abs(ahead) % 60];
  const sign = ahead < 0 ? "−" : "+";
  return `UTC${sign}${hours}${minutes === 0 ? "" : `:${String(minutes).padStart(2, "0")}`}`;
}

/** "20 Nov 2025, 21:04:10". */
export function dateTime(t: number): string {
  return `${day(t)}, ${clockTime(t)}`;
}

/** "21:04:10", and "20 Nov 2025, 21:04:10" where that may be of either of two days. */
export function timeIn({ from, to }: { from: number; to: number }, t: number): string {
  return day(from) === day(to) ? clockTime(t) : dateTime(t);
}

/** So many days are told apart on one bar; more are a wrong clock's. */
const MOST_DAYS = 31;

/** The local midnights between two moments (Unix s). */
export function midnights({ from, to }: { from: number; to: number }): number[] {
  const found: number[] = [];
  const next = new Date(from * 1000);
  next.setHours(24, 0, 0, 0);
  while (next.getTime() / 1000 < to && found.length <= MOST_DAYS) {
    found.push(next.getTime() / 1000);
    next.setDate(next.getDate() + 1);
  }
  return found.length > MOST_DAYS ? [] : found;
}

/** "2025-11-20T20:04:10Z": what cannot be misread in another time zone. */
export function utc(t: number): string {
  return new Date(t * 1000).toISOString().replace(/\.\d+Z$/, "Z");
}

/** How far before the end: "−3:05", "−1:02:00", "0:00". */
export function beforeEnd(seconds: number): string {
  const whole = Math.max(0, Math.round(seconds));
  const two = (value: number) => String(value).padStart(2, "0");
  const hours = Math.floor(whole / 3600);
  const minutes = Math.floor((whole % 3600) / 60);
  const text = hours > 0 ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
  return whole === 0 ? text : `−${text}`;
}
