// Runs independent jobs in module workers. A job is an object with its kind; job_worker.mjs has the kinds.

export class Runner {
  #limit;
  #idle = [];
  #running = new Map(); // worker → task
  #waiting = [];

  /** Creates a runner of at most so many workers; each worker starts with its first job. */
  constructor(workers = Math.max(1, navigator.hardwareConcurrency ?? 1)) {
    this.#limit = workers;
  }

  /**
   * Queues a job. `result` is a promise: a failed job rejects with an `Error` of one line, a cancelled job
   * with an `AbortError`. `onPiece` receives the partial results of the job.
   */
  submit(job, onPiece = () => {}) {
    const task = { job, onPiece };
    const result = new Promise((resolve, reject) => Object.assign(task, { resolve, reject }));
    this.#waiting.push(task);
    this.#start();
    return { result, cancel: () => this.#cancel(task) };
  }

  /** Cancels all jobs and terminates the workers. A later job starts new workers. */
  terminate() {
    const tasks = this.#waiting.splice(0).concat([...this.#running.values()]);
    for (const worker of [...this.#running.keys(), ...this.#idle]) this.#close(worker);
    tasks.forEach(abort);
  }

  #start() {
    while (this.#waiting.length > 0 && (this.#idle.length > 0 || this.#running.size < this.#limit)) {
      const worker = this.#idle.pop() ?? this.#open();
      const task = this.#waiting.shift();
      this.#running.set(worker, task);
      worker.postMessage(task.job);
    }
  }

  #open() {
    const worker = new Worker(new URL("job_worker.mjs", import.meta.url), { type: "module" });
    worker.onmessage = ({ data }) => this.#receive(worker, data);
    // A script that cannot be loaded sends no message.
    worker.onerror = ({ message }) =>
      this.#receive(worker, { error: message ?? "the program could not be loaded", isBroken: true });
    return worker;
  }

  #close(worker) {
    worker.terminate();
    this.#running.delete(worker);
    this.#idle = this.#idle.filter((idle) => idle !== worker);
  }

  /** Handles a message of a worker: a partial result, the result or an error. */
  #receive(worker, { piece, result, error, isBroken }) {
    const task = this.#running.get(worker);
    if (!task) return; // the job was cancelled or has failed
    if (piece !== undefined) return task.onPiece(piece);
    if (isBroken) {
      this.#close(worker);
    } else {
      this.#running.delete(worker);
      this.#idle.push(worker);
    }
    if (error === undefined) task.resolve(result);
    else task.reject(new Error(error));
    this.#start();
  }

  #cancel(task) {
    this.#waiting = this.#waiting.filter((waiting) => waiting !== task);
    // A worker cannot interrupt a solve.
    for (const [worker, running] of this.#running) if (running === task) this.#close(worker);
    abort(task);
    this.#start();
  }
}

/** Rejects the result of a task; a finished task is left unchanged. */
const abort = (task) => task.reject(new DOMException("The job was cancelled.", "AbortError"));
