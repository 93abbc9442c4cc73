// Inside the framed 3-D view, before viser's own script. Its bundle prepares a sorter for Gaussian
// splats that wants eval; our policy forbids eval, we show no splats, and the refusal is harmless.
for (const kind of ["unhandledrejection", "error"])
  addEventListener(kind, (event) => {
    if ((event.reason ?? event.error) instanceof EvalError) event.preventDefault();
  }, true);
