// Checks manifests, a JSON list on standard input, by Kubernetes' own schemas: types, required fields, formats, and that each field
// is one that the schema has. Runs in a folder with node_modules. Exit status 77 where the schemas are not there.
// usage: node kubernetes_schema.mjs < MANIFESTS.json
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(process.cwd() + "/");
try {
  require.resolve("kubernetes-models/package.json");
} catch {
  console.log("skipped: no package kubernetes-models beside " + process.cwd() + " (deploy/install --tests DIR)");
  process.exit(77);
}

// The compiled schemas ignore unknown fields, but never read them: `unread` holds the paths of fields that nothing has read.
function noting(value, path, unread) {
  if (typeof value !== "object" || value === null) return value;
  const known = new Map();
  for (const key of Object.keys(value)) {
    unread.add(`${path}/${key}`);
    known.set(key, noting(value[key], `${path}/${key}`, unread));
  }
  return new Proxy(value, {
    get(target, key) {
      if (!known.has(key)) return target[key];
      unread.delete(`${path}/${key}`);
      return known.get(key);
    },
  });
}

let faults = 0;
for (const manifest of JSON.parse(readFileSync(0, "utf8"))) {
  const name = `${manifest.kind} ${manifest.metadata?.name}`;
  const unread = new Set();
  const found = [];
  try {
    const models = require(`kubernetes-models/${manifest.apiVersion}/${manifest.kind}`);
    // On an object of the class it would check a copy.
    models[manifest.kind].prototype.validate.call(noting(manifest, "", unread));
  } catch (failed) {
    found.push(failed.message);
  }
  if (found.length === 0) found.push(...[...unread].map((path) => `the schema has no ${path}`));
  for (const fault of found) console.log(`${name}: ${fault}`);
  faults += found.length;
}
process.exit(faults === 0 ? 0 : 1);
