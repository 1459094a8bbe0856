// The physics of the page, in a thread of its own. It gets { open } once, { letter } often, and { slow } to be hindered; it posts { report }, { failed } or { ready }.
// Works as a module worker and as a classic one: modules are loaded either way by import().

/** How long it works before it looks for letters. Milliseconds. */
const BUDGET_MS = 8;

let forerun;
let physics;
let scheduled = false;

// A message to oneself lets letters in between, and unlike a timer it is not delayed.
const turns = new MessageChannel();
turns.port1.onmessage = () => attempt(turn);

const waiting = [];

onmessage = async ({ data }) => {
  if (data.open) {
    try {
      forerun = await import("./forerun_web.js");
      await forerun.default({ module_or_path: new URL("forerun_web_bg.wasm", location.href) });
      postMessage({ ready: true });
      attempt(() => open(data.open));
    } catch (error) {
      postMessage({ failed: `the physics cannot be loaded: ${error.message ?? error}` });
    }
  } else if (physics) {
    attempt(() => take(data));
  } else {
    waiting.push(data);
  }
};

function open({ name, text, recording }) {
  physics = recording ? forerun.PhysicsWorker.resumed(recording) : new forerun.PhysicsWorker(name, text);
  waiting.splice(0).forEach(take);
  publish();
  schedule();
}

function take({ letter, slow }) {
  if (slow) {
    physics.hinder(slow[0], slow[1]);
  } else {
    physics.receive(new Uint8Array(letter));
  }
  schedule();
}

function turn() {
  scheduled = false;
  const more = physics.work(BUDGET_MS);
  publish();
  if (more) {
    schedule();
  }
}

function publish() {
  const report = physics.publish();
  if (report) {
    postMessage({ report: report.buffer }, [report.buffer]);
  }
}

function schedule() {
  if (!scheduled) {
    scheduled = true;
    turns.port2.postMessage(0);
  }
}

function attempt(work) {
  try {
    work();
  } catch (error) {
    postMessage({ failed: forerun.last_panic() ?? `${error.message ?? error}` });
  }
}
