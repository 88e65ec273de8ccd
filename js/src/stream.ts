// Jobs in workers for as long as jobs come, in bounded memory.

/** The runner of web/runner.js. */
export interface Pool {
  submit(job: object, options: { name: string }): { result: Promise<string>; cancel(): void };
  stats(): { workers: number };
  withWorkers(workers: number): Pool;
  terminate(): void;
}

/** Entries that are read ahead of the lines, for each worker: none waits for the next entry. */
const AHEAD = 8;

/** How a stream runs. */
export interface Stream<Entry, Line> {
  pool: Pool;
  /** Does the pool end with the stream? */
  isOwn: boolean;
  ordered: boolean;
  signal: AbortSignal | undefined;
  /** The job of an entry; an exception is the entry's error. */
  job: (entry: Entry) => object;
  /** The line of an entry from its result, an object, or from its error. */
  line: (entry: Entry, index: number, answer: object) => Line;
}

/** Yields a line for each entry. */
export async function* stream<Entry, Line>(
  entries: Iterable<Entry> | AsyncIterable<Entry>,
  { pool, isOwn, ordered, signal, job, line }: Stream<Entry, Line>,
): AsyncGenerator<Line, void, void> {
  const source = Symbol.asyncIterator in entries ? entries[Symbol.asyncIterator]() : entries[Symbol.iterator]();
  const ahead = AHEAD * pool.stats().workers;
  const cancels = new Map<number, () => void>(); // of the jobs that run
  const ready = new Map<number, Line>();
  let count = 0;
  let next = 0; // index of the next line
  let isReading = false;
  let isEnd = false;
  let isOver = false; // no further entry becomes a job
  let failure: { error: unknown } | undefined; // of the source or of the whole pool
  let wake = () => {};

  const run = async (entry: Entry, index: number) => {
    let answer: object;
    try {
      const { result, cancel } = pool.submit(job(entry), { name: `scene ${index}` });
      cancels.set(index, cancel);
      answer = JSON.parse(await result);
    } catch (error) {
      // The pool was terminated.
      if (error instanceof DOMException && error.name === "AbortError") failure ??= { error };
      answer = { error: error instanceof Error ? error.message : String(error) };
    }
    cancels.delete(index);
    ready.set(index, line(entry, index, answer));
    wake();
  };
  const read = async () => {
    isReading = true;
    try {
      const { done, value } = await source.next();
      // A job after the end would start a worker.
      if (isOver || failure) return;
      if (done) isEnd = true;
      else void run(value, count++);
    } catch (error) {
      failure = { error };
    }
    isReading = false;
    wake();
  };
  const end = () => {
    isOver = true;
    for (const cancel of cancels.values()) cancel();
    if (isOwn) pool.terminate();
    wake();
  };

  signal?.addEventListener("abort", end);
  try {
    for (;;) {
      signal?.throwIfAborted();
      if (failure) throw failure.error;
      if (!isEnd && !isReading && count - next < ahead) void read();
      const index = ordered ? next : ready.keys().next().value;
      const found = index === undefined ? undefined : ready.get(index);
      if (index !== undefined && found !== undefined) {
        ready.delete(index);
        next += 1; // of lines in any order: their number
        yield found;
      } else if (isEnd && next === count) {
        return;
      } else {
        await new Promise<void>((resolve) => {
          wake = resolve;
        });
      }
    }
  } finally {
    signal?.removeEventListener("abort", end);
    end();
    // A source that waits for an entry would hold back the end.
    if (!isEnd) Promise.resolve(source.return?.()).catch(() => {});
  }
}
