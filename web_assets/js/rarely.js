// Many values on the way to one place: those that come too quickly are left out, never the last.

/**
 * @template T
 * @param {number} ms between two calls of send
 * @param {(value: T) => unknown} send
 * @returns {(value: T) => void}
 */
export function rarely(ms, send) {
  let sent = -Infinity;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let late;
  return (value) => {
    clearTimeout(late);
    const now = () => {
      sent = performance.now();
      send(value);
    };
    const wait = ms - (performance.now() - sent);
    if (wait <= 0) now();
    else late = setTimeout(now, wait);
  };
}
