const kMostInMatrix = 14;
const kCell = 13;

/// A matrix of objects that touch each other: those with the newest contacts.
class Matrix {
  constructor(canvas) {
    this.canvas = canvas;
    this.text = null;
  }
  forget() { this.text = this.shownAt = null; }

  /// Once a second: faster changes cannot be read anyway.
  show(contacts, now) {
    const wide = this.canvas.parentElement.clientWidth;
    const every_ms = 1000;
    if (wide === 0 || now - (this.shownAt ?? -Infinity) < every_ms) return;
    this.shownAt = now;
    const met = new Map();
    for (const contact of contacts.newest()) {
      for (const name of [contact.a, contact.b]) if (met.size < kMostInMatrix && !met.has(name)) met.set(name, met.size);
    }
    const names = [...met.keys()].sort();
    const text = `${names.join("\n")}|${contacts.changes}|${wide}`;
    if (text === this.text) return;
    this.text = text;
    this.draw(contacts, names, wide);
  }

  draw(contacts, names, wide) {
    const { canvas } = this;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const labels = wide - kCell * names.length;
    const height = Math.max(16, kCell * names.length + 4);
    canvas.width = wide * ratio;
    canvas.height = height * ratio;
    canvas.style.width = `${wide}px`;
    canvas.style.height = `${height}px`;
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    const pen = penOf(canvas);
    pen.scale(ratio, ratio);
    pen.font = "11px 'DejaVu Sans', Arial, sans-serif";
    pen.textBaseline = "middle";
    if (names.length === 0) {
      pen.fillStyle = color("--quiet");
      pen.fillText("nothing has met anything yet", 0, 8);
    }
    const place = new Map(names.map((name, i) => [name, i]));
    names.forEach((name, i) => {
      pen.fillStyle = color("--ink");
      pen.fillText(isolated(shortened(pen, name, labels - 6)), 0, i * kCell + kCell / 2 + 1);
      pen.strokeStyle = color("--faint");
      for (let j = 0; j <= i; ++j) pen.strokeRect(labels + j * kCell + 0.5, i * kCell + 1.5, kCell - 2, kCell - 2);
    });
    for (const { a, b, holds, times } of contacts.newest()) {
      const [i, j] = [place.get(a), place.get(b)];
      if (i === undefined || j === undefined) continue;
      pen.globalAlpha = holds ? 1 : Math.min(0.6, 0.15 + 0.1 * times);
      pen.fillStyle = holds ? color("--accent") : color("--ink");
      pen.fillRect(labels + Math.min(i, j) * kCell + 2, Math.max(i, j) * kCell + 3, kCell - 5, kCell - 5);
    }
    pen.globalAlpha = 1;
    const held = contacts.newest().filter(({ holds }) => holds);
    canvas.setAttribute("aria-label", held.length ? `Which objects meet which; now ${held.slice(0, 5).map(({ a, b }) => `${a} and ${b}`).join(", ")}` : "Which objects meet which; now none");
  }
}

/// The end of a name, as much of it as fits.
function shortened(pen, text, width) {
  if (pen.measureText(text).width <= width) return text;
  let kept = [...text];
  while (kept.length > 1 && pen.measureText(`…${kept.join("")}`).width > width) kept = kept.slice(Math.max(1, Math.floor(kept.length / 8)));
  return `…${kept.join("")}`;
}
