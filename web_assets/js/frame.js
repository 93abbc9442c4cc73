// Inside the framed 3-D view, before viser's own script. Its bundle prepares a sorter for Gaussian
// splats that wants eval; our policy forbids eval, we show no splats, and the refusal is harmless.

/** @param {ErrorEvent | PromiseRejectionEvent} event */
function harmless(event) {
  const error = "reason" in event ? event.reason : event.error;
  if (error instanceof EvalError) event.preventDefault();
}

addEventListener("unhandledrejection", harmless, true);
addEventListener("error", harmless, true);
