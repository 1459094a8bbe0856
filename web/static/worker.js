// The physics of the page, in a thread of its own. It gets { open } once and { letter } often, and posts { report }, { failed } or { ready }.
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
      await forerun.default();
      postMessage({ ready: true });
      attempt(() => open(data.open));
    } catch (error) {
      postMessage({ failed: `the physics cannot be loaded: ${error.message ?? error}` });
    }
  } else if (physics) {
    attempt(() => receive(data.letter));
  } else {
    waiting.push(data.letter);
  }
};

function open({ name, text, slow }) {
  physics = new forerun.PhysicsWorker(name, text);
  if (slow) {
    physics.hinder(slow[0], slow[1]);
  }
  waiting.splice(0).forEach(receive);
  publish();
  schedule();
}

function receive(letter) {
  physics.receive(new Uint8Array(letter));
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
