// What the page itself has to say. No module: it also runs where modules do not.

/** Shows a message over the picture, until it is clicked; with none, takes the last one away. */
function tell(message) {
  const notice = document.getElementById("notice");
  notice.textContent = message;
  notice.hidden = !message;
}

/** Some script of the page is not there. */
function notLoaded() {
  if (location.protocol === "file:") {
    tell("Browsers load the parts of this page from a server only, not from files. Start one in this folder, for example by “python3 -m http.server”, and open http://localhost:8000.");
  } else {
    tell("A part of the viewer could not be loaded; the browser's console says which. All files of the folder must be there, and the server must call those in .js text/javascript. Browsers older than 2023 are too old.");
  }
}

addEventListener("click", ({ target }) => {
  if (target.id === "notice") {
    tell("");
  }
});
