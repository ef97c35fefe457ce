/// The objects as a tree: scenes and publishers, their objects, and the parts of those. Only visible rows exist, so a
/// hundred thousand objects scroll like ten.
class Things {
  /// on: {choose(slot), frame(object), changed()}
  constructor(world, on) {
    this.world = world;
    this.on = on;
    this.folded = new Set();  // groups, by key
    this.opened = new Set();  // objects whose parts are listed, by name
    this.rows = [];
    this.cursor = 0;
    this.chosen = null;
    this.list = byId("things");
    this.body = element("div", { role: "presentation" });
    this.list.append(this.body);
    this.list.addEventListener("scroll", () => this.showRows());
    this.list.addEventListener("keydown", (event) => this.press(event));
    new ResizeObserver(() => this.showRows()).observe(this.list);
    this.coarse = matchMedia("(pointer: coarse)");
    byId("search").addEventListener("input", () => this.build());
    byId("show-all").addEventListener("click", () => this.showEverything());
  }

  rowHeight() { return this.coarse.matches ? 44 : 24; }

  /// The group of an object: moving ones belong to their publisher, the rest to their scene.
  groupOf(object) {
    if (object.publisher) return ["publisher", object.publisher];
    if (object.scene) return ["scene", object.scene];
    return object.moving ? ["moving", object.publisher === "" ? "added by clients" : "moving"] : ["still", "added by clients"];
  }

  build() {
    const wanted = byId("search").value.trim();
    const expression = wanted ? globExpression(wanted) : null;
    const groups = new Map();
    let count = 0;
    for (const object of this.world.objects.values()) {
      if (expression && !expression.test(object.name)) continue;
      ++count;
      const [kind, name] = this.groupOf(object);
      const key = `${kind} ${name}`;
      if (!groups.has(key)) groups.set(key, { key, kind, name, objects: [] });
      groups.get(key).objects.push(object);
    }
    const { compare } = new Intl.Collator("en", { numeric: true });
    this.rows = [];
    for (const group of [...groups.values()].sort((a, b) => compare(a.key, b.key))) {
      this.rows.push({ group });
      if (this.folded.has(group.key) && !expression) continue;
      group.objects.sort((a, b) => compare(a.name, b.name));
      for (const object of group.objects) {
        this.rows.push({ object, group });
        if (this.opened.has(object.name)) for (const text of partTexts(object)) this.rows.push({ object, group, part: text });
      }
    }
    byId("thing-count").textContent = expression ? `${countText(count)} of ${countText(this.world.objects.size)}` : countText(count);
    byId("no-things").hidden = count > 0;
    byId("no-things").textContent = expression ? "no object has such a name" : "no objects";
    this.body.style.height = `${this.rows.length * this.rowHeight()}px`;
    this.cursor = Math.min(this.cursor, Math.max(0, this.rows.length - 1));
    this.showRows();
  }

  showRows() {
    const height = this.rowHeight();
    const first = Math.max(0, Math.floor(this.list.scrollTop / height) - 2);
    const last = Math.min(this.rows.length, first + Math.ceil(this.list.clientHeight / height) + 5);
    const items = [];
    for (let i = first; i < last; ++i) items.push([this.rowKey(i, height), () => this.row(i, height)]);
    keepChildren(this.body, items);
    const isNear = this.cursor >= first && this.cursor < last;
    if (isNear) this.list.setAttribute("aria-activedescendant", `thing-${this.cursor}`);
    else this.list.removeAttribute("aria-activedescendant");
  }

  /// Changes with the content of a row.
  rowKey(i, height) {
    const { group, object, part } = this.rows[i];
    const cursor = i === this.cursor;
    if (part) return `${i} ${height} ${cursor} ${object.name} ${part}`;
    if (!object) return `${i} ${height} ${cursor} ${group.key} ${this.folded.has(group.key)} ${group.objects.length} ${group.objects.every((one) => one.isHidden)}`;
    const shown = this.world.states[object.slot] & (kInContact | kInDoubt | kStale | kHidden);
    return `${i} ${height} ${cursor} ${object.name} ${shown} ${object.slot === this.chosen} ${this.opened.has(object.name)}`;
  }

  row(i, height) {
    const { group, object, part } = this.rows[i];
    if (part) return this.partRow(i, height, part);
    const isHidden = object ? object.isHidden : group.objects.every((one) => one.isHidden);
    const eye = element("button", {
      type: "button", class: "eye", tabindex: -1, "aria-pressed": !isHidden, "aria-label": isHidden ? "Show" : "Hide",
      onclick: (event) => { event.stopPropagation(); this.hide(object ? [object] : group.objects, !isHidden); },
    }, isHidden ? "○" : "●");
    const row = element("div", {
      role: "treeitem", id: `thing-${i}`, class: `${object ? "object" : "group"}${isHidden ? " hidden" : ""}${i === this.cursor ? " cursor" : ""}`,
      "aria-level": object ? 2 : 1, "aria-selected": Boolean(object && object.slot === this.chosen), onclick: () => this.open(i),
      ondblclick: () => { if (object) this.on.frame(object); },
    });
    this.place(row, i, height);
    if (object) {
      const state = this.world.states[object.slot];
      const mark = element("i", { class: state & kInDoubt ? "doubt" : state & kInContact ? "touching" : state & kStale ? "stale" : object.moving ? "moving" : "still" });
      const isOpen = this.opened.has(object.name);
      if (partCount(object) > 1) {
        row.setAttribute("aria-expanded", isOpen);
        row.append(element("i", { class: "fold", onclick: (event) => { event.stopPropagation(); this.openParts(i, !isOpen); } }, isOpen ? "▾" : "▸"));
      }
      row.append(mark, element("span", { class: "name", title: object.name }, nameElement(nameWithin(group, object))), eye);
    } else {
      const isFolded = this.folded.has(group.key);
      row.setAttribute("aria-expanded", !isFolded);
      row.append(element("i", { class: "fold" }, isFolded ? "▸" : "▾"), element("span", { class: "name", title: group.name }, element("small", {}, group.kind === "publisher" || group.kind === "scene" ? `${group.kind} ` : ""), nameElement(group.name)), element("small", {}, countText(group.objects.length)), eye);
    }
    return row;
  }

  partRow(i, height, part) {
    const row = element("div", { role: "treeitem", id: `thing-${i}`, class: `part${i === this.cursor ? " cursor" : ""}`, "aria-level": 3, onclick: () => this.open(i) }, element("span", { class: "name", title: part }, part));
    this.place(row, i, height);
    return row;
  }
  place(row, i, height) {
    row.style.top = `${i * height}px`;
    row.style.height = `${height}px`;
  }
  openParts(i, isOpen) {
    const { object } = this.rows[i];
    isOpen ? this.opened.add(object.name) : this.opened.delete(object.name);
    this.build();
  }

  /// Chooses the row's object, or folds its group.
  open(i) {
    this.cursor = i;
    const { group, object } = this.rows[i];
    if (object) return this.on.choose(object.slot);
    this.folded.has(group.key) ? this.folded.delete(group.key) : this.folded.add(group.key);
    this.build();
  }

  press(event) {
    const row = this.rows[this.cursor];
    if (!row || event.ctrlKey || event.altKey || event.metaKey) return;
    const page = Math.max(1, Math.floor(this.list.clientHeight / this.rowHeight()) - 1);
    const by = { ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -Infinity, End: Infinity }[event.key];
    if (by !== undefined) this.cursor = Math.max(0, Math.min(this.rows.length - 1, this.cursor + by));
    else if (event.key === "ArrowRight" || event.key === "ArrowLeft") this.fold(row, event.key === "ArrowLeft");
    else if (event.key === "Enter" || event.key === " ") this.open(this.cursor);
    else if (event.key === "h") this.hide(row.object ? [row.object] : row.group.objects, !(row.object || row.group.objects[0]).isHidden);
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.scrollTo(this.cursor);
    this.showRows();
  }

  fold(row, isFolded) {
    const hasParts = row.object && !row.part && partCount(row.object) > 1;
    if (row.part && isFolded) this.cursor = this.rows.findIndex(({ object, part }) => object === row.object && !part);
    else if (hasParts && isFolded !== !this.opened.has(row.object.name)) this.openParts(this.cursor, !isFolded);
    else if (row.object && isFolded) this.cursor = this.rows.findIndex(({ group, object }) => group === row.group && !object);
    else if (!row.object && isFolded !== this.folded.has(row.group.key)) this.open(this.cursor);
  }

  scrollTo(i) {
    const height = this.rowHeight();
    this.list.scrollTop = Math.min(i * height, Math.max(this.list.scrollTop, (i + 1) * height - this.list.clientHeight));
  }

  /// Marks an object as the chosen one and brings its row into view.
  setChosen(slot) {
    this.chosen = slot;
    const row = slot === null ? -1 : this.rows.findIndex(({ object, part }) => object?.slot === slot && !part);
    if (row >= 0) {
      this.cursor = row;
      this.scrollTo(row);
    }
    this.showRows();
  }

  // ---- what is visible in the picture

  hide(objects, isHidden) {
    for (const object of objects) {
      object.isHidden = isHidden;
      this.world.setState(object.slot, kHidden, isHidden);
    }
    this.changed();
  }
  /// Draws everything but one object faintly; null: everything as it is.
  isolate(slot) {
    this.isolated = slot;
    this.world.objects.forEach((object) => this.world.setState(object.slot, kFaint, slot !== null && object.slot !== slot));
    this.changed();
  }
  showEverything() {
    this.hide([...this.world.objects.values()].filter((object) => object.isHidden), false);
    this.isolate(null);
  }
  changed() {
    this.showRows();
    byId("show-all").hidden = (this.isolated ?? null) === null && ![...this.world.objects.values()].some((object) => object.isHidden);
    this.on.changed();
  }

  /// The answer to "owners": the objects that each publisher moves.
  setOwners(owners) {
    for (const { publisher, slots } of owners) for (const slot of slots) if (this.world.objects.has(slot)) this.world.objects.get(slot).publisher = publisher;
    this.build();
  }
}

/// A scene's name precedes those of its objects; below the scene it is redundant.
function nameWithin({ kind, name }, object) {
  const isPrefix = kind === "scene" && object.name.startsWith(`${name}/`) && object.name.length > name.length + 1;
  return isPrefix ? object.name.slice(name.length + 1) : object.name;
}

const partCount = ({ parts, runs }) => parts.length + runs.length;

/// The parts of an object, a text for each, the first thousand.
function partTexts({ parts, runs }) {
  const mostTold = 1000;
  const told = [...runs.map(([, , triangles]) => `mesh, ${countText(triangles)} triangles`), ...parts.map(partText)];
  return told.length > mostTold ? [...told.slice(0, mostTold), `and ${countText(told.length - mostTold)} more`] : told;
}

/// part: as in page_messages.hpp
function partText([kind, ...n]) {
  const sides = (half) => half.map((part) => lengthText(2 * part)).join(" × ");
  const between = () => lengthText(length(subtract(n.slice(3, 6), n.slice(0, 3))));
  if (kind === 0) return `sphere, radius ${lengthText(n[3])}`;
  if (kind === 1) return `box ${sides(n.slice(7, 10))}`;
  if (kind === 5) return `ellipsoid ${sides(n.slice(7, 10))}`;
  if (kind === kHalfSpace) return "half-space";
  return `${{ 2: "capsule", 3: "cylinder", 4: "cone" }[kind]}, radius ${lengthText(n[6])}, ${between()} long`;
}
