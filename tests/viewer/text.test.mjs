// node text.test.mjs VIEWER: what chunks.json says is shown as text. No script of the viewer has a way
// to turn text into elements or into a program.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

const [viewer] = process.argv.slice(2);
const kWays = /innerHTML|outerHTML|insertAdjacentHTML|setHTML|srcdoc|document\.write|\beval\(|new Function/;
const files = readdirSync(viewer).filter((name) => /\.(js|mjs|html)$/.test(name));
assert.ok(files.includes("viewer.js"));
for (const name of files) {
  assert.equal(readFileSync(join(viewer, name), "utf8").match(kWays)?.[0], undefined, name);
}
