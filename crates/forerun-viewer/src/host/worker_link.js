// The page's end of the way to its physics worker.

const NOT_LOADED = "the physics worker cannot be loaded: worker.js and forerun_web.js must be there, and the server must call them text/javascript";

export class WorkerLink {
  #worker;
  #reports = [];
  #failed;

  constructor(module, name, text, recording) {
    try {
      this.#worker = new Worker("worker.js", { type: "module" });
      this.#listen();
      this.#worker.postMessage({ open: { module, name, text, recording } });
    } catch (error) {
      this.#failed = `the browser starts no worker: ${error.message}`;
    }
  }

  #listen() {
    this.#worker.onmessage = ({ data }) => {
      if (data.report) {
        this.#reports.push(data.report);
      } else {
        this.#failed ??= data.failed;
      }
    };
    this.#worker.onerror = (event) => {
      // Told where the scene would be; the page goes on.
      event.preventDefault();
      this.#failed ??= event.message || NOT_LOADED;
    };
  }

  post(letter) {
    this.#worker?.postMessage({ letter: letter.buffer }, [letter.buffer]);
  }

  hinder(from_ms, to_ms) {
    this.#worker?.postMessage({ slow: [from_ms, to_ms] });
  }

  take() {
    const report = this.#reports.shift();
    return report && new Uint8Array(report);
  }

  failure() {
    return this.#failed;
  }

  end() {
    this.#worker?.terminate();
  }
}
