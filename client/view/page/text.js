// Numbers as text, rounded for reading. Commands that can be typed again have all digits (asking.js).

function lengthText(metres) {
  if (metres === null || metres === undefined) return "-";
  if (!Number.isFinite(metres)) return String(metres);
  const size = Math.abs(metres);
  if (size === 0) return "0 m";
  for (const [unit, factor] of [["m", 1], ["mm", 1e-3], ["µm", 1e-6], ["nm", 1e-9]]) {
    if (size >= factor || unit === "nm") return `${Number((metres / factor).toPrecision(4))} ${unit}`;
  }
}

/// How deep two objects are in each other; a depth within its error bound is a touch.
function depthText({ depth, error, doubt, contained }) {
  if (doubt) return "undecided";
  if (contained) return "inside";
  if (!(Number(depth) > 0) || Number(depth) <= Number(error || 0)) return "touching";
  const size = Number(depth);
  if (size < 1e-6) return "< 1 µm";
  if (size < 1e-3) return `${(size * 1e6).toFixed(0)} µm`;
  return size < 1 ? `${(size * 1e3).toFixed(1)} mm` : `${size.toFixed(3)} m`;
}

/// A point, to a tenth of a millimetre.
const pointText = (point) => point.map((part) => roundedText(part, 4)).join(" ");
function roundedText(value, digits) {
  const rounded = Number(Number(value).toFixed(digits));
  return String(rounded === 0 ? 0 : rounded);  // no -0
}

function durationText(seconds) {
  if (seconds === null || seconds === undefined) return "-";
  if (seconds < 1e-3) return `${Number((seconds * 1e6).toPrecision(3))} µs`;
  if (seconds < 1) return `${Number((seconds * 1e3).toPrecision(3))} ms`;
  return seconds < 120 ? `${Number(seconds.toPrecision(3))} s` : `${Math.round(seconds / 60)} min`;
}

function rateText(perSecond) {
  if (perSecond < 999.5) return `${Number(perSecond.toPrecision(3))}/s`;
  return perSecond < 999950 ? `${(perSecond / 1e3).toFixed(1)} k/s` : `${(perSecond / 1e6).toFixed(1)} M/s`;
}

/// "12 345"
const countText = (count) => String(Math.round(count)).replace(/\B(?=(\d{3})+$)/g, "\u2009");

function clockText(seconds) {
  const tenYears = 315360000;
  if (seconds < tenYears) return `${seconds.toFixed(3)} s`;
  return new Date(seconds * 1000).toLocaleTimeString("en-GB") + (seconds % 1).toFixed(3).slice(1);
}

/// Invisible characters, and those that reverse the order of others, are written out: "\u202e".
const visible = (name) => name.replace(/[\p{Cc}\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]/gu, (sign) => `\\u${sign.codePointAt(0).toString(16).padStart(4, "0")}`);
/// The direction of a name must not reverse adjacent text.
const isolated = (name) => `\u2068${visible(name)}\u2069`;

/// An element with attributes and children; texts are never read as HTML.
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children);
  return made;
}
/// A long name breaks after its slashes if possible.
const nameElement = (name) => element("bdi", {}, ...visible(name).split("/").flatMap((part, i, all) => (i + 1 < all.length ? [`${part}/`, element("wbr")] : [part])));

/// The beginning and the end of a long name: in lists, one name must not displace all others.
const shortName = (name) => ([...name].length > 40 ? `${[...name].slice(0, 18).join("")}…${[...name].slice(-18).join("")}` : name);
function shortNameElement(name) {
  const made = nameElement(shortName(name));
  if (shortName(name) !== name) made.title = visible(name);
  return made;
}

/// Makes an element's children those of a list, rebuilding only those with a changed key: the others need not be laid
/// out and painted again. items: [[key, make()]].
function keepChildren(parent, items) {
  items.forEach(([key, make], i) => {
    const known = parent.children[i];
    if (known && known.key === key) return;
    // After an insertion the next children are found one position later.
    const later = parent.children[i + 1];
    if (known && later && later.key === key) return known.remove();
    const made = make();
    made.key = key;
    const isInserted = known && items[i + 1] && known.key === items[i + 1][0];
    if (known && !isInserted) known.replaceWith(made);
    else parent.insertBefore(made, known || null);
  });
  while (parent.children.length > items.length) parent.lastElementChild.remove();
}
function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}
/// The pen of a canvas that is drawn by the processor: far faster without a real graphics card.
const penOf = (canvas) => canvas.getContext("2d", { willReadFrequently: true });
const byId = (id) => document.getElementById(id);

const isGlob = (text) => /[*?[]/.test(text);
/// A name glob (* ? [..]) as a regular expression, case-insensitive; a text without these characters is found anywhere.
function globExpression(glob) {
  if (!isGlob(glob)) return new RegExp(glob.replace(/[.+^${}()|\\\]]/g, "\\$&"), "iu");
  let text = "";
  for (let at = 0; at < glob.length; ++at) {
    const sign = glob[at];
    const end = glob.indexOf("]", at + 2);
    if (sign === "*") text += ".*";
    else if (sign === "?") text += ".";
    else if (sign === "[" && end > 0) {
      const not = /[!^]/.test(glob[at + 1]);
      text += `[${not ? "^" : ""}${glob.slice(at + 1 + not, end).replace(/[\\\]^[]/g, "\\$&")}]`;
      at = end;
    } else text += sign.replace(/[.+^${}()|\\[\]]/g, "\\$&");
  }
  try {
    return new RegExp(`^${text}$`, "isu");
  } catch {
    return /$^/u;  // "[z-a]": an empty range
  }
}
