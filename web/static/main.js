// Starts the viewer in the page's canvas. Everything else is in the WebAssembly module and in worker.js.

import init, * as forerun from "./forerun_web.js";

const notice = document.getElementById("notice");

function tell(message) {
  notice.textContent = message;
  notice.hidden = !message;
}

window.addEventListener("error", ({ error, message }) => {
  // The window library leaves its starting function by an exception; that is no error.
  if (!`${error?.message ?? message}`.includes("isn't actually an error")) {
    tell(forerun.last_panic() ?? `${error?.message ?? message}`);
  }
});

/** The state of the viewer, for scripts. */
window.forerun_state = () => JSON.parse(forerun.forerun_state());

window.addEventListener("dragover", (event) => event.preventDefault());
window.addEventListener("drop", async (event) => {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (file) {
    forerun.open_text(file.name, await file.text());
  }
});

const wishes = new URLSearchParams(location.search);
// To see that the page does not mind: `?slow=200-1000` makes every frame of the physics so many milliseconds slower.
const slow = wishes.get("slow")?.split("-").map(Number);

try {
  await init();
  tell("");
  forerun.run_page(wishes.get("scene") ?? "dominoes", slow ? [slow[0], slow[1] ?? slow[0]] : undefined);
} catch (error) {
  if (!`${error}`.includes("isn't actually an error")) {
    tell(`The viewer cannot start: ${forerun.last_panic?.() ?? error.message ?? error}. It needs a browser with WebAssembly SIMD and WebGL 2.`);
  }
}
