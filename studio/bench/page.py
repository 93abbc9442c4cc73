"""What the page costs in a Chromium: until it is there, what it draws, and what holds it up."""

import time
from typing import Any

from studio.evaluation.browser import MISSING, browser, found
from studio.evaluation.served import PAGE_LIMIT, served

WARM_UP = 5.0
"""s that the page draws before anything is counted."""
PATIENCE = 3.0 * PAGE_LIMIT
"""s to wait for the figures at most: without a graphics card, on a busy machine, a minute."""
# s from the navigation until the figures are drawn, and bytes of our own scripts until then.
_READY = """new Promise(done => {
  const look = () => {
    const [figures] = performance.getEntriesByName('figures');
    if (!figures) return setTimeout(look, 20);
    const ready = figures.startTime;  // whoever looks late has not to count what came since
    const own = performance.getEntriesByType('resource').filter(({ name, responseEnd }) =>
      new URL(name).pathname.startsWith('/assets/js/') && responseEnd <= ready);
    done([ready / 1000, own.reduce((sum, one) => sum + one.decodedBodySize, 0), own.length]);
  };
  look();
})"""
# Frames of the 3-D view a second, and those among them in which the person had moved.
_DRAWN = """new Promise(done => {
  const view = document.querySelector('#view').contentWindow, began = performance.now();
  const joints = [];
  view.__viserMutable.nodeRefFromName['/human/joints'].traverse((mesh) => {
    if (mesh.getMatrixAt && mesh.instancesCount) joints.push(mesh);
  });
  const place = () => joints.map((mesh) => {
    let sum = 0;
    for (let i = 0; i < mesh.instancesCount; i += 1)
      sum += mesh.getMatrixAt(i).elements[14] * (i + 1);
    return sum;
  }).join();
  let count = 0, moved = 0, last = place();
  const step = () => {
    const lasted = (performance.now() - began) / 1000, now = place();
    count += 1;
    if (now !== last) moved += 1;
    last = now;
    lasted < SECONDS ? view.requestAnimationFrame(step) : done([count / lasted, moved / lasted]);
  };
  view.requestAnimationFrame(step);
})"""


def page(seconds: float) -> dict[str, Any]:
    """The page of an operator who tours every task, opened once before; {"skipped": why} without
    a browser.

    ready_s: from the navigation until the figures are drawn. own_js_bytes, own_js_files: of our
    own scripts that came by then. frames_per_second: of the 3-D view; updates_per_second: those in
    which the figures had moved. longest_block_ms, blocked_share: the longest task of the page's
    main thread while it draws, and the share of the time in tasks over 50 ms, both traced.
    """
    if found() is None:
        return {"skipped": MISSING}
    with served() as server, browser(server.url) as shown:
        shown.evaluate(_READY, PATIENCE)  # the first time compiles and fetches
        shown.open(server.url)
        ready, own_bytes, own_files = shown.evaluate(_READY, PATIENCE)
        time.sleep(WARM_UP)
        frames, updates = shown.evaluate(
            _DRAWN.replace("SECONDS", str(seconds)), seconds + PAGE_LIMIT
        )
        tasks = shown.tasks_ms(seconds)
    return {
        "ready_s": ready,
        "own_js_bytes": own_bytes,
        "own_js_files": own_files,
        "frames_per_second": frames,
        "updates_per_second": updates,
        "longest_block_ms": max(tasks, default=0.0),
        "blocked_share": sum(ms for ms in tasks if ms > 50.0) / (1e3 * seconds),
    }
