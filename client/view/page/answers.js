// Answers to questions of the user, rounded for reading, and the commands that give them with all digits.

/// A number that reads back as the same double, without an exponent that could confuse a shell user.
const fullText = (value) => (Object.is(value, -0) ? "0" : String(value));
const fullPoint = (point) => point.map(fullText).join(" ");

/// A word for a shell. Invisible characters, and those that reverse others, are escaped, so that users run only what
/// they see.
function shellWord(word) {
  if (/^[A-Za-z0-9_./:][-A-Za-z0-9_./:]*$/.test(word)) return word;
  if (visible(word) === word) return `'${word.replaceAll("'", "'\\''")}'`;
  const escaped = word.replace(/[\\']/g, "\\$&").replace(/[\p{Cc}\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]/gu, (sign) => `\\u${sign.codePointAt(0).toString(16).padStart(4, "0")}`);
  return `$'${escaped}'`;
}

/// The command line that gives the same answer. connection: the options that connect to this server.
function commandText(connection, question) {
  const words = {
    ray: ({ origin, direction }) => `${fullPoint(origin)}  ${fullPoint(direction)}`,
    sphere: ({ center, radius }) => `${fullPoint(center)} ${fullText(radius)}`,
    box: ({ center, half }) => `--center ${fullPoint(center)} --size ${fullPoint(half.map((part) => 2 * part))}`,
    near: ({ point, count }) => `${fullPoint(point)} -k ${count}`,
    sweep: ({ radius, from, to }) => `sphere ${fullText(radius)} --from ${fullPoint(from)} --to ${fullPoint(to)}`,
    pair: ({ a, b }) => `${a.startsWith("-") || b.startsWith("-") ? "-- " : ""}${shellWord(a)} ${shellWord(b)}`,
  }[question.ask];
  return `collide ${connection}${question.ask} ${words(question)}`;
}

/// The bound is the difference between a rounded number and the server's exact decision.
function boundText(error) {
  const bound = Number(error);
  return bound === 0 ? "exact" : `± ${bound < 1e-9 ? "less than 1 nm" : lengthText(bound)}`;
}
const directionText = (direction) => direction.map((part) => roundedText(part, 3)).join(" ");

function costText({ cost, age }, took_ms) {
  const parts = cost ? [`${durationText(cost.compute)} on the server: ${countText(cost.nodes)} nodes, ${countText(cost.exact_tests)} exact tests`] : [`answered after ${durationText(took_ms / 1000)}`];
  if (age !== undefined) parts.push(`poses ${durationText(age)} old`);
  return parts.join("; ");
}

/// The description of an answer: texts and elements.
function answerParts(question, answer) {
  if (answer.answer === "undecided" || answer.answer === "invalid") return [`${answer.answer} ${(answer.reason || "").replaceAll("_", " ")}`, ...hitList(question, answer)];
  const parts = {
    ray: rayParts, pair: pairParts, sweep: sweepParts,
    sphere: () => (answer.hits.length ? [`${hitCountText(answer)} the sphere of ${lengthText(question.radius)}`, ...hitList(question, answer)] : [`nothing touches the sphere of ${lengthText(question.radius)}`]),
    box: () => (answer.hits.length ? [`${hitCountText(answer)} the box of ${question.half.map((part) => lengthText(2 * part)).join(" × ")}`, ...hitList(question, answer)] : ["nothing touches the box"]),
    near: () => (answer.hits.length ? [`nearest to ${pointText(question.point)} m`, ...hitList(question, answer)] : ["there is nothing"]),
  }[question.ask];
  return parts(answer, question);
}

function rayParts(answer) {
  if (answer.answer !== "hit") return ["miss: nothing along the ray"];
  return ["hit ", nameElement(answer.object), ` at ${lengthText(Number(answer.distance))} (${boundText(answer.error)}), point ${pointText(answer.point)} m, normal ${directionText(answer.normal)}`];
}

function pairParts(answer) {
  const names = [nameElement(answer.a), " and ", nameElement(answer.b)];
  if (answer.answer === "miss") return [...names, ` are ${lengthText(answer.distance)} apart (${boundText(answer.error)})`];
  const depth = depthText(answer);
  return [...names, depth === "touching" ? " touch" : ` are ${depth} deep in each other`, ` (${boundText(answer.error)})`];
}

function sweepParts(answer, { from, to }) {
  const way = length(subtract(to, from));
  const [hit] = answer.hits;
  if (!hit) return [`free: nothing is met on the way of ${lengthText(way)}`];
  const bound = way * (hit.time_high - hit.time_low);
  return ["meets ", nameElement(hit.object), hit.inside ? " where it begins" : ` after ${lengthText(way * hit.time_low)} (${boundText(bound)}) of ${lengthText(way)}, point ${pointText(hit.point)} m, normal ${directionText(hit.normal)}`];
}

const hitCountText = ({ hits, left_out }) => (hits.length + left_out === 1 ? "1 thing touches" : `${countText(hits.length + left_out)} things touch`);

/// The first hits, one a line: a depth or a distance, its bound, the name.
function hitList({ ask }, { hits, left_out }) {
  if (!hits || !hits.length || ask === "sweep") return [];
  const mostShown = 6;
  const rows = hits.slice(0, mostShown).map(({ object, distance, error, inside }) => {
    const size = ask !== "near" ? depthText({ depth: distance, error }) : inside ? "inside" : lengthText(Number(distance));
    return element("li", {}, element("span", { class: "depth" }, size), element("span", {}, shortNameElement(object), element("small", {}, ` ${boundText(error)}`)));
  });
  const more = hits.length + left_out - rows.length;
  if (more > 0) rows.push(element("li", { class: "quiet" }, `and ${countText(more)} more`));
  return [element("ul", { class: "contacts" }, ...rows)];
}
