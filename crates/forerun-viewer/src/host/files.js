// Files of the web page: the browser's storage, downloads, and its dialog for a scene.

const KEY = "forerun-viewer";

export function load() {
  // A browser may forbid storage altogether.
  try { return localStorage.getItem(KEY) ?? undefined; } catch { return undefined; }
}

export function keep(text) {
  try { localStorage.setItem(KEY, text); } catch { /* then nothing is kept */ }
}

export function download(name, content) {
  // The memory of the module may move: the copy is the browser's.
  const url = URL.createObjectURL(new Blob([content.slice()]));
  const link = Object.assign(document.createElement("a"), { href: url, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

export class Dialog {
  #decided = false;
  #name = undefined;
  #text = undefined;

  constructor() {
    const input = Object.assign(document.createElement("input"), { type: "file", accept: ".toml,.json" });
    input.addEventListener("cancel", () => { this.#decided = true; });
    input.addEventListener("change", async () => {
      const file = input.files[0];
      if (file) {
        this.#name = file.name;
        this.#text = await file.text();
      }
      this.#decided = true;
    });
    input.click();
  }

  decided() { return this.#decided; }
  name() { return this.#name; }
  text() { return this.#text; }
}
