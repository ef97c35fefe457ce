// Colors that colour-blind people can distinguish: Okabe and Ito, "Color Universal Design", 2008.
const kPalette = [[0, 114, 178], [230, 159, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [213, 94, 0], [240, 228, 66], [120, 120, 120]];

// For objects that moved within this many seconds; the warmer the more recently.
const kAges = [[0.2, [213, 94, 0]], [2, [230, 159, 0]], [20, [240, 228, 66]], [Infinity, [86, 180, 233]]];

/// Colors by the time since an object last moved, as observed by the page.
function coloringByAge(world) {
  const strength = 140;
  const gray = [120, 120, 120];
  const colorOf = (object) => [...(object.moving ? kAges.find(([most]) => world.worldTime - (object.movedAt ?? -Infinity) < most)?.[1] ?? kAges.at(-1)[1] : gray), strength];
  const texts = kAges.map(([most]) => (most === Infinity ? "longer ago" : `moved within ${durationText(most)}`));
  return { colorOf, legend: [...kAges.map(([, color], i) => [color, texts[i]]), [gray, "does not move"]] };
}

/// A function from an object to its color by a property, and what each color means: {colorOf, legend [[color, text]]}.
function coloring(property, world) {
  if (property === "age") return coloringByAge(world);
  const valueOf = {
    scene: (object) => object.scene || "no scene",
    publisher: (object) => (object.moving ? object.publisher || "no publisher told" : "does not move"),
    layer: (object) => `layers ${object.layers.toString(2)}`,
    state: (object) => (object.stale || world.hasState(object.slot, kStale) ? "stale" : object.moving ? "moves" : "does not move"),
  }[property];
  if (!valueOf) return { colorOf: null, legend: [] };
  const strength = 110;
  const colors = new Map();
  const of = (value) => {
    if (!colors.has(value)) colors.set(value, kPalette[Math.min(colors.size, kPalette.length - 1)]);
    return colors.get(value);
  };
  for (const object of world.objects.values()) of(valueOf(object));
  return { colorOf: (object) => [...of(valueOf(object)), strength], legend: [...colors].slice(0, 12).map(([text, color]) => [color, text]) };
}
