// Runs independent jobs in module workers. A job is an object with its kind; job_worker.js has the kinds.
//
// A worker that stops (a panic, a trap, a script error, silence) is replaced, and its job runs once more,
// in a new worker. A job that stops its second worker too is rejected with one line that names the job.

/** Name of the workers: job_worker.js has an effect only under this name. */
const NAME = "implant-preview job";

/** As many workers as the machine has cores, less one for the page. */
const defaultWorkers = () => Math.max(1, (navigator.hardwareConcurrency ?? 1) - 1);

/** Number of attempts to run a job. */
const ATTEMPTS = 2;
/** Number of workers in a row that do not start, after which the runner opens no more. */
const FAILED_STARTS = 2;
/** Time without a message after which a worker with a job counts as stopped [ms]: far above the longest solve. */
const PATIENCE = 600_000;
/** Number of looks at the clock within the patience; a machine that sleeps in between delays one look. */
const LOOKS = 5;
/** Time in which a worker may finish a cancelled job [ms]; a new worker would take about as long to start. */
const GRACE = 200;

export class Runner {
  #load;
  #address;
  #patience;
  #workers;
  #limit;
  #slots = new Set(); // workers with their tasks: the first runs, the second is with the worker already
  #waiting = new Set(); // tasks in the order of submission
  #repeated = []; // tasks whose worker has stopped
  #failedStarts = 0;
  #clock = null;
  #counters = { jobs: 0, started: 0, restarted: 0, failed: 0 };

  /**
   * Creates a runner; each worker starts with its first job.
   *
   * `program`: address of the module with the functions of the API. `wasm`, optional: the compiled
   * `WebAssembly.Module`, which all workers share, or the address of the file. `workers`: greatest number of
   * workers. `address`: address of job_worker.js. `patience`: time [ms] without a message after which a worker
   * with a job counts as stopped.
   */
  constructor({
    program,
    wasm,
    workers = defaultWorkers(),
    address = new URL("job_worker.js", import.meta.url),
    patience = PATIENCE,
  }) {
    this.#load = { program: String(program), wasm };
    this.#address = address;
    this.#patience = patience;
    this.#workers = this.#limit = workers;
  }

  /**
   * Queues a job. `result` is a promise: a failed job rejects with an `Error` of one line, a cancelled job
   * with an `AbortError`. `onPiece` receives the partial results of the job; a second attempt repeats them.
   * `name` stands in the error of a job that has stopped its workers.
   */
  submit(job, { onPiece = () => {}, name } = {}) {
    const task = { job, onPiece, name: name ?? `job ${this.#counters.jobs} (${job.kind})`, attempts: 0 };
    this.#counters.jobs += 1;
    const result = new Promise((resolve, reject) => Object.assign(task, { resolve, reject }));
    this.#waiting.add(task);
    this.#start();
    return { result, cancel: () => this.#cancel(task) };
  }

  /** Cancels all jobs and terminates the workers. A later job starts new workers. */
  terminate() {
    const tasks = this.#takeWaiting();
    for (const slot of this.#slots) {
      tasks.push(...slot.tasks);
      this.#close(slot);
    }
    this.#watch();
    tasks.forEach(abort);
  }

  /** A runner of the same program with workers of its own, at most this number. */
  withWorkers(workers) {
    return new Runner({ ...this.#load, workers, address: this.#address, patience: this.#patience });
  }

  /**
   * Counters: `workers`, the greatest number of workers; `alive`, workers that exist. Since the creation of the
   * runner: `jobs` submitted; workers `started`; `restarted`, jobs that have stopped a worker and run again; `failed`,
   * jobs without a result, because they stopped two workers or no worker starts.
   */
  stats() {
    return { workers: this.#limit, alive: this.#slots.size, ...this.#counters };
  }

  #start() {
    while (this.#repeated.length + this.#waiting.size > 0) {
      const [task] = this.#repeated.length > 0 ? this.#repeated : this.#waiting;
      const slot = this.#slotFor(task);
      if (!slot) break;
      if (this.#repeated[0] === task) this.#repeated.shift();
      this.#waiting.delete(task);
      task.attempts += 1;
      slot.tasks.push(task);
      slot.worker.postMessage(task.job);
    }
    this.#watch();
  }

  /** The worker that gets a task now, if there is one. */
  #slotFor(task) {
    const slots = [...this.#slots];
    const idle = slots.find((slot) => slot.tasks.length === 0);
    const isRepeated = task.attempts > 0; // in a new worker
    if (idle && !isRepeated) return idle;
    if (idle && slots.length >= this.#limit) this.#close(idle);
    if (this.#slots.size < this.#limit) return this.#open();
    // With its next job a worker does not wait for a busy page. The last jobs go to the workers that finish first.
    if (isRepeated || this.#waiting.size < this.#limit) return null;
    return slots.find((slot) => slot.tasks.length === 1);
  }

  #open() {
    const worker = new Worker(this.#address, { type: "module", name: NAME });
    const slot = { worker, tasks: [], isReady: false, looks: 0 };
    this.#slots.add(slot);
    this.#counters.started += 1;
    worker.onmessage = ({ data }) => this.#receive(slot, data);
    worker.onerror = (event) => {
      event.preventDefault(); // the job reports the error
      // A script that cannot be loaded has no message.
      this.#stopped(slot, event.message ?? "the program could not be loaded");
    };
    worker.onmessageerror = () => this.#stopped(slot, "a message could not be read");
    worker.postMessage(this.#load);
    return slot;
  }

  #close(slot) {
    slot.worker.terminate();
    this.#slots.delete(slot);
  }

  /** Handles a message of a worker: the program is loaded, a partial result, the result or an error. */
  #receive(slot, { isReady, piece, result, error, isBroken }) {
    if (!this.#slots.has(slot)) return; // sent before the end of the worker
    if (isBroken) return this.#stopped(slot, error);
    slot.looks = 0;
    if (isReady) {
      slot.isReady = true;
      this.#failedStarts = 0;
      return;
    }
    const [task] = slot.tasks;
    if (piece !== undefined) return task.isCancelled || task.onPiece(piece);
    slot.tasks.shift();
    if (error === undefined) task.resolve(result);
    else task.reject(new Error(error));
    this.#limitCancelled(slot);
    this.#start();
  }

  /** Replaces a stopped worker; repeats its job or rejects the job. */
  #stopped(slot, cause) {
    if (!this.#slots.has(slot)) return;
    this.#close(slot);
    const line = String(cause).replace(/\s+/g, " ").trim();
    const [task, ...next] = slot.tasks;
    this.#return(slot.isReady ? next : slot.tasks);
    if (!slot.isReady) {
      this.#failedStarts += 1;
      const ready = [...this.#slots].filter(({ isReady }) => isReady).length;
      if (this.#failedStarts >= FAILED_STARTS) this.#limit = ready;
      if (this.#limit === 0) return this.#giveUp(line);
    } else if (task && !task.isCancelled) {
      if (task.attempts < ATTEMPTS) {
        this.#counters.restarted += 1;
        this.#repeated.push(task);
      } else {
        this.#fail(task, `${task.name}: internal error, twice: ${line}`);
      }
    }
    this.#start();
  }

  /** Takes tasks back that have not begun. */
  #return(tasks) {
    const left = tasks.filter((task) => !task.isCancelled);
    for (const task of left) task.attempts -= 1;
    this.#repeated.push(...left);
  }

  #takeWaiting() {
    const tasks = [...this.#repeated, ...this.#waiting];
    this.#repeated = [];
    this.#waiting.clear();
    return tasks;
  }

  /** Rejects all jobs, because no worker starts. A later job tries again. */
  #giveUp(line) {
    this.#limit = this.#workers;
    this.#failedStarts = 0;
    for (const slot of this.#slots) {
      this.#close(slot);
      this.#return(slot.tasks);
    }
    for (const task of this.#takeWaiting()) this.#fail(task, `${task.name}: no worker starts: ${line}`);
    this.#watch();
  }

  #fail(task, line) {
    this.#counters.failed += 1;
    task.reject(new Error(line));
  }

  #cancel(task) {
    task.isCancelled = true;
    this.#waiting.delete(task);
    this.#repeated = this.#repeated.filter((repeated) => repeated !== task);
    for (const slot of this.#slots) if (slot.tasks[0] === task) this.#limitCancelled(slot);
    abort(task);
  }

  /** Ends a worker that does not finish a cancelled job soon: a worker cannot interrupt a solve. */
  #limitCancelled(slot) {
    const [task] = slot.tasks;
    if (!task?.isCancelled) return;
    setTimeout(() => {
      if (slot.tasks[0] !== task || !this.#slots.has(slot)) return;
      this.#close(slot);
      this.#return(slot.tasks);
      this.#start();
    }, GRACE);
  }

  /** Looks for silent workers as long as jobs run. */
  #watch() {
    if ([...this.#slots].every((slot) => slot.tasks.length === 0)) {
      clearInterval(this.#clock);
      this.#clock = null;
    } else {
      this.#clock ??= setInterval(() => this.#look(), this.#patience / LOOKS);
    }
  }

  #look() {
    for (const slot of this.#slots) {
      slot.looks = slot.tasks.length > 0 ? slot.looks + 1 : 0;
      if (slot.looks > LOOKS) this.#stopped(slot, `no answer for ${Math.round(this.#patience / 1000)} s`);
    }
  }
}

/** Rejects the result of a task; a finished task is left unchanged. */
const abort = (task) => task.reject(new DOMException("The job was cancelled.", "AbortError"));
