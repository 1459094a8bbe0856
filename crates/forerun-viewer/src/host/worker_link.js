// The page's end of the way to its physics worker.

export class WorkerLink {
  constructor(name, text, recording) {
    this.reports = [];
    this.failed = undefined;
    this.first = { open: { name, text, recording } };
    this.slow = undefined;
    this.begin({ type: "module" });
  }

  begin(options) {
    this.worker = new Worker("worker.js", options);
    let ready = false;
    this.worker.onmessage = ({ data }) => {
      ready = true;
      if (data.report) {
        this.reports.push(data.report);
      } else if (data.failed) {
        this.failed ??= data.failed;
      }
    };
    this.worker.onerror = (event) => {
      if (!ready && options.type === "module") {
        // A browser without module workers: the same file is a classic one too.
        this.begin({});
      } else {
        this.failed ??= event.message ?? "the physics worker cannot be loaded";
      }
    };
    this.worker.postMessage(this.first);
    if (this.slow) {
      this.worker.postMessage(this.slow);
    }
  }

  post(letter) {
    this.worker.postMessage({ letter: letter.buffer }, [letter.buffer]);
  }

  hinder(from_ms, to_ms) {
    this.slow = { slow: [from_ms, to_ms] };
    this.worker.postMessage(this.slow);
  }

  take() {
    const report = this.reports.shift();
    return report && new Uint8Array(report);
  }

  failure() {
    return this.failed;
  }

  end() {
    this.worker.terminate();
  }
}
