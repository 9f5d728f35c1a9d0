// Instants as a page writes them.

/** Milliseconds since 1970 of a date, a number, RFC 3339 text or "now". */
export function milliseconds(epoch) {
  const ms = epoch instanceof Date ? epoch.getTime() : typeof epoch === "string" ? (epoch === "now" ? Date.now() : Date.parse(epoch)) : Number(epoch);
  if (!Number.isFinite(ms)) throw new TypeError(`The epoch ${epoch} is no date; write it as 2026-01-31T12:00:00Z, now or live.`);
  return ms;
}

/** The time since the start of its year, as a fraction of it. */
export function yearFraction(ms) {
  const year = new Date(ms).getUTCFullYear();
  const start = Date.UTC(year, 0);
  return (ms - start) / (Date.UTC(year + 1, 0) - start);
}
