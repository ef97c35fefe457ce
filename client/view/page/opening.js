const kMostFileBytes = 1 << 30;

/// Opens recordings: files that are dropped on the page or chosen, and what the server itself remembers.
class Opening {
  /// on: {surroundings() (as for RecordedRun), ask(question) -> id or null, whyNotSent(), opened(run, name), say(text)}
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

  async openFile(file) {
    if (file.size > kMostFileBytes) return this.on.say(`${visible(file.name)} has ${countText(file.size / 1e6)} MB; a page opens 1000 at most`);
    await this.read(file.name, () => file.arrayBuffer());
  }

  askMemory() {
    const seconds = 30;
    this.asked = this.on.ask({ ask: "memory", seconds });
    this.on.say(this.asked === null ? this.on.whyNotSent() : "asking the server for what it remembers");
  }
  async hear({ id, path }) {
    if (id !== this.asked) return;
    await this.read("the server's last 30 s", async () => {
      const reply = await fetch(path);
      if (!reply.ok) throw new Error("the viewer no longer has it");
      return reply.arrayBuffer();
    });
  }
  refused({ id, why }) {
    if (id === this.asked) this.on.say(why);
  }

  async read(name, bytes) {
    this.on.say(`reading ${visible(name)}`);
    try {
      const run = new RecordedRun(await bytes(), this.on.surroundings());
      if (!run.entries.some(({ kind }) => kind === "poses")) throw new Error("nothing in it has a place");
      this.on.opened(run, name);
      const notes = [run.damage, run.broken ? `${countText(run.broken)} samples could not be read` : ""].filter(Boolean);
      this.on.say(notes.length ? `${visible(name)}: ${notes.join("; ")}` : "");
    } catch (failed) {
      this.on.say(`${visible(name)}: ${failed.message}`);
    }
  }
}
