const kMostFileBytes = 1 << 30;

/// Opens recordings: files that are dropped on the page or chosen, and the server's own memory. The viewer reads them,
/// and returns them as runs, like those of saved pages.
class Recordings {
  /// on: {isSaved, ask(question) -> id or null, whyNotSent(), opened({entries, end}, name), say(text)}
  constructor(on) {
    this.on = on;
    window.addEventListener("dragover", (event) => {
      if ([...event.dataTransfer.types].includes("Files")) event.preventDefault();
    });
    window.addEventListener("drop", (event) => {
      const [file] = event.dataTransfer.files;
      if (!file) return;
      event.preventDefault();
      this.openFile(file);
    });
    byId("open").addEventListener("click", () => byId("file").click());
    byId("file").addEventListener("change", () => {
      if (byId("file").files[0]) this.openFile(byId("file").files[0]);
      byId("file").value = "";
    });
    byId("memory").addEventListener("click", () => this.askMemory());
  }

  openFile(file) {
    if (this.on.isSaved) return this.on.say("this page is a saved run: it has no viewer that could read a recording");
    if (file.size > kMostFileBytes) return this.on.say(`${visible(file.name)} has ${countText(Math.ceil(file.size / (1 << 20)))} MiB; a viewer reads ${countText(kMostFileBytes >> 20)} at most`);
    this.sending?.abort();
    // fetch() does not report how much was sent.
    const sending = new XMLHttpRequest();
    this.sending = sending;
    const end = (why) => this.on.say(`${visible(file.name)}: ${why}`);
    sending.open("POST", "recording");
    sending.upload.onprogress = ({ loaded, total }) => this.on.say(`sending ${visible(file.name)}: ${Math.floor((100 * loaded) / total)} %`);
    sending.upload.onload = () => this.on.say(`reading ${visible(file.name)}`);
    sending.onload = () => (sending.status === 200 ? this.show(file.name, sending.responseText) : end(sending.responseText));
    sending.onerror = () => end("the viewer broke off");
    this.on.say(`sending ${visible(file.name)}`);
    sending.send(file);
  }

  askMemory() {
    const seconds = 30;
    this.asked = this.on.ask({ ask: "memory", seconds });
    this.on.say(this.asked === null ? this.on.whyNotSent() : "asking the server for what it remembers");
  }
  async hear({ id, path }) {
    if (id !== this.asked) return;
    const reply = await fetch(path);
    if (reply.ok) await this.show("the server's last 30 s", await reply.text());
    else this.on.say("the viewer no longer has what the server remembered");
  }
  refused({ id, why }) {
    if (id === this.asked) this.on.say(why);
  }

  async show(name, text) {
    try {
      const run = JSON.parse(text);
      const entries = [];
      const source = new SavedSource(run, (t, kind, value) => entries.push({ t, kind, value }));
      await source.unpack();
      this.on.opened({ entries, end: source.duration() }, name);
      this.on.say(run.notes.length ? `${visible(name)}: ${run.notes.join("; ")}` : "");
    } catch (failed) {
      this.on.say(`${visible(name)}: ${failed.message}`);
    }
  }
}
