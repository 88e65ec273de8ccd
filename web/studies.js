// Studies of the JavaScript API on the workers of runner.js. Each function returns its handle { cancel, done }.

/**
 * A handle of jobs with the functions that receive their results. `done` resolves after the last result; after
 * `cancel()` it rejects with an `AbortError`, and no further result is received. An exception of a receiver
 * cancels the jobs and rejects `done`.
 */
function handle(run) {
  const jobs = new Set();
  let isOver = false;
  const cancel = () => {
    isOver = true;
    for (const job of jobs) job.cancel();
  };
  /** Submits a job; calls `receive` with the result, or with null and the line of the error. */
  const submit = (runner, job, name, receive) => {
    const submitted = runner.submit(job, { name });
    jobs.add(submitted);
    const finish = (result, error) => {
      jobs.delete(submitted);
      if (!isOver) receive(result, error);
    };
    return submitted.result.then(
      (result) => finish(result, null),
      (error) => {
        if (error.name === "AbortError") throw error;
        finish(null, error.message);
      },
    );
  };
  const done = run(submit).catch((error) => {
    cancel();
    throw error;
  });
  done.catch(() => {}); // a caller without use for `done` gets no message in the console
  return { cancel, done };
}

/** Solves scenes (list of JSON texts). A scene without a result has the result `{"error": LINE}`. */
export function simulateMany(runner, scenes, onResult) {
  return handle(async (submit) => {
    const solve = (scene, index) =>
      submit(runner, { kind: "simulate", scene }, `scene ${index}`, (result, error) =>
        onResult(index, result ?? JSON.stringify({ error })),
      );
    await Promise.all(scenes.map(solve));
  });
}
