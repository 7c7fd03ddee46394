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

/** "20 Nov 2025, 21:04:10". */
export function dateTime(t: number): string {
  return `${day(t)}, ${clockTime(t)}`;
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
