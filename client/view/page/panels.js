/// Rows of a table: [name, text, text ..., isWrong]; names are isolated, the others are right-aligned numbers.
function fillTable(table, rows) {
  keepChildren(table, rows.map(({ name, cells, isWrong }) => [`${name}\n${cells.join("\n")}\n${isWrong}`, () => element("tr", { class: isWrong ? "wrong" : "" },
    element("th", { scope: "row" }, shortNameElement(name)), ...cells.map((text) => element("td", {}, text)))]));
}

/// Remembers a few choices in the browser, if it lets a page do so.
const remembered = {
  get(key, otherwise) {
    try {
      return JSON.parse(localStorage.getItem(`collided ${key}`)) ?? otherwise;
    } catch {
      return otherwise;
    }
  },
  set(key, value) {
    try {
      localStorage.setItem(`collided ${key}`, JSON.stringify(value));
    } catch { /* a page of a file, or one that may keep nothing */ }
  },
};

/// The panels next to the picture with the server's activity.
class Panels {
  constructor() {
    this.publishers = [];
    this.publishersAt = 0;
    this.rates = new Map();  // by publisher: {messages, at, rate}
    for (const panel of document.querySelectorAll("details[id]")) {
      panel.open = remembered.get(panel.id, panel.open);
      panel.addEventListener("toggle", () => { if (!isPhone()) remembered.set(panel.id, panel.open); });
    }
    this.setUpSheets();
  }

  // ---- on a phone, one panel at a time over the lower half of the picture

  setUpSheets() {
    const tabs = [...document.querySelectorAll("#tabs button")];
    const show = (panel) => {
      document.body.dataset.sheet = panel || "";
      for (const tab of tabs) tab.setAttribute("aria-expanded", tab.dataset.panel === panel);
      for (const each of document.querySelectorAll("#panels details")) {
        each.classList.toggle("sheet", each.id === panel);
        if (each.id === panel) each.open = true;
      }
      window.dispatchEvent(new Event("resize"));
    };
    for (const tab of tabs) tab.addEventListener("click", () => show(document.body.dataset.sheet === tab.dataset.panel ? "" : tab.dataset.panel));
    this.closeSheet = () => show("");
  }

  showStatus(status, now) {
    const scenes = `${status.scenes.join("\n")}\n${status.objects} ${status.moving}`;
    if (scenes !== this.scenesText) byId("scenes").replaceChildren(...(status.scenes.length ? status.scenes.flatMap((scene, i) => [i ? ", " : "", nameElement(scene)]) : ["no scene"]), ` · ${countText(status.objects)} objects, ${countText(status.moving)} moving`);
    this.scenesText = scenes;
    const isBusy = status.step_lasting > 0.5;
    const busy = isBusy ? `, step has lasted ${durationText(status.step_lasting)}` : "";
    this.showState(`${status.state}${busy} · collided ${status.version_text}, pid ${status.pid}`, isBusy || status.state !== "ready");
    for (const { name, messages } of status.publishers) {
      const known = this.rates.get(name);
      if (known && now - known.at < 900) continue;
      const rate = known && messages >= known.messages ? (1000 * (messages - known.messages)) / (now - known.at) : null;
      this.rates.set(name, { messages, at: now, rate });
    }
    for (const name of this.rates.keys()) if (!status.publishers.some((one) => one.name === name)) this.rates.delete(name);
    this.publishers = status.publishers;
    this.publishersAt = now;
    const doubt = status.in_doubt ? ` · ${countText(status.in_doubt)} undecided` : "";
    setText(byId("contact-count"), status.contacts_truncated ? `${countText(status.contacts)}, more are not told` : `${countText(status.contacts)} hold${doubt}`);
    this.showRecent(status.recent || { asked: [], stages: [], steps: null });
  }

  showState(text, isWrong) {
    setText(byId("state"), text);
    byId("state").className = isWrong ? "wrong" : "";
  }

  showRecent(recent) {
    setText(byId("step"), recent.steps === null ? "not told" : `${rateText(recent.steps)}, ${durationText(recent.step_p50)} each`);
    const least = 0.01;  // of a core: smaller loads have short bars
    const busy = Math.max(least, recent.stages.reduce((sum, { share }) => sum + share, 0));
    keepChildren(byId("stages"), recent.stages.map(({ stage, share }) => {
      const width = `${((100 * share) / busy).toFixed(1)}%`;
      const text = `${(100 * share).toFixed(1)} %`;
      return [`${stage} ${width} ${text}`, () => {
        const bar = element("i");
        bar.style.width = width;
        return element("div", { class: "bar" }, element("span", {}, stage), element("span", { class: "track" }, bar), element("span", {}, text));
      }];
    }));
    const asked = recent.asked.filter(({ rate }) => rate > 0);
    setText(byId("asked"), asked.length ? "" : "nobody asks");
    byId("kinds-head").hidden = asked.length === 0;
    fillTable(byId("kinds"), asked.map(({ kind, rate, p50, p99 }) => ({ name: kind, cells: [rateText(rate), durationText(p50), durationText(p99)] })));
  }

  /// Lets the ages shown grow between two statuses. now: null while an instant of the past is shown, where they are
  /// fixed.
  showPublishers(now) {
    const since = now === null ? 0 : (now - this.publishersAt) / 1000;
    const mostShown = 24;
    const rows = this.publishers.map(({ name, silent, lost }) => {
      const age = silent + since;
      const rate = this.rates.get(name)?.rate;
      return { name, cells: [lost ? "lost" : rate === null || rate === undefined ? "-" : rateText(rate), durationText(age)], isWrong: lost || age > 2 };
    });
    setText(byId("publisher-count"), rows.length ? countText(rows.length) : "nobody publishes");
    byId("publishers-head").hidden = rows.length === 0;
    fillTable(byId("publishers"), rows.length > mostShown ? [...rows.slice(0, mostShown), { name: `and ${rows.length - mostShown} more`, cells: ["", ""] }] : rows);
  }
}

const isPhone = () => matchMedia("(max-width: 699px)").matches;
