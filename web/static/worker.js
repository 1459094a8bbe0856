// The physics of the page, in a thread of its own. It gets { open } once, { letter } often, and { slow } to be hindered; it posts { report } or, at its end, { failed }.

import * as forerun from "./forerun_web.js";

/** How long it works before it looks for letters. Milliseconds. */
const BUDGET_MS = 8;

let physics;
let scheduled = false;
/** Whether something went wrong: what is in memory then is not to be touched any more. */
let ended = false;

// A message to oneself lets letters in between, and unlike a timer it is not delayed.
const turns = new MessageChannel();
turns.port1.onmessage = () => attempt(turn);

const waiting = [];

onmessage = async ({ data }) => {
  if (data.open) {
    try {
      // The page has compiled it already.
      await forerun.default({ module_or_path: data.open.module });
      attempt(() => open(data.open));
    } catch (error) {
      fail(`the physics cannot be loaded: ${error.message ?? error}`);
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
  if (ended) {
    return;
  }
  try {
    work();
  } catch (error) {
    fail(forerun.panic_message() ?? `${error.message ?? error}`);
  }
}

function fail(message) {
  ended = true;
  postMessage({ failed: message });
}
