// node times.mjs FILE.usda FPS FRAME FILE.off ...: fails unless three.js and TinyUSDZ read from the
// .usda so many time codes a second and a sample of each attribute at each frame, and three.js of
// points and faces those of the frame's .off.
import { readFileSync } from "node:fs";
import { USDAParser } from "three/addons/loaders/usd/USDAParser.js";

const [usda, fps, ...rest] = process.argv.slice(2);
const frames = [];
for (let i = 0; i < rest.length; i += 2) frames.push({ number: Number(rest[i]), off: rest[i + 1] });
const numbers = frames.map((frame) => frame.number);
const text = readFileSync(usda, "utf8");
const bad = [];
const expect = (found, truth, what) => {
  if (String(found) !== String(truth)) bad.push(`${what}: ${found}, and not ${truth}`);
};

const { specsByPath } = new USDAParser().parseData(text);
expect(specsByPath["/"].fields.timeCodesPerSecond, fps, "three.js, timeCodesPerSecond");
const samples = {};
for (const [path, { fields }] of Object.entries(specsByPath)) {
  if (fields.timeSamples) samples[path.split(".").pop()] = fields.timeSamples;
}
const names = ["extent", "faceVertexCounts", "faceVertexIndices", "points", "normals"];
expect(Object.keys(samples).sort(), [...names].sort(), "three.js, attributes");

const turned = ([a, b, c]) => (a < b && a < c ? [a, b, c] : b < c ? [b, c, a] : [c, a, b]);
const trianglesOf = (indices) => {
  const triangles = [];
  for (let i = 0; i < indices.length; i += 3) triangles.push(turned([...indices.slice(i, i + 3)]).join(" "));
  return triangles.sort().join(", ");
};
frames.forEach(({ number, off }, i) => {
  const [, counts, ...lines] = readFileSync(off, "utf8").split("\n");
  const [vertices, faces] = counts.split(" ").map(Number);
  const points = lines.slice(0, vertices).flatMap((line) => line.split(" ").map(Number));
  const corners = lines.slice(vertices, vertices + faces).flatMap((line) => line.split(" ").slice(1, 4).map(Number));
  for (const name of names) expect(samples[name].times, numbers, `three.js, times of ${name}`);
  const found = samples.points.values[i];
  const far = Math.max(...points.map((x, k) => Math.abs(x - found[k])));
  if (found.length !== points.length || !(far < 1e-6)) bad.push(`frame ${number}: other points, ${far} away`);
  expect(samples.faceVertexCounts.values[i].length, faces, `frame ${number}, faces`);
  if (trianglesOf(samples.faceVertexIndices.values[i]) !== trianglesOf(corners)) {
    bad.push(`frame ${number}: other triangles`);
  }
  expect(samples.normals.values[i].length, 9 * faces, `frame ${number}, numbers of normals`);
  console.log(`frame ${number}: ${vertices} points, ${faces} faces`);
});

// The package is for browsers; all that it needs of one is to be told so.
process.type = "renderer";
globalThis.window = globalThis;
const { default: start } = await import("tinyusdz/tinyusdz.js");
const binary = readFileSync(new URL("node_modules/tinyusdz/tinyusdz.wasm", import.meta.url));
const module = await start({
  instantiateWasm(imports, done) {
    WebAssembly.instantiate(binary, imports).then(({ instance, module }) => done(instance, module));
    return {};
  },
});
const loader = new module.TinyUSDZLoaderNative();
if (!loader.loadAsLayerFromBinary(new Uint8Array(readFileSync(usda)), usda)) bad.push(loader.error());
const printed = loader.layerToString();
for (const name of names) {
  const at = printed.indexOf(`${name}.timeSamples = {`);
  const lines = at < 0 ? [] : printed.slice(at, printed.indexOf("}", at)).split("\n").slice(1);
  const times = lines.map((line) => parseFloat(line)).filter((time) => !Number.isNaN(time));
  expect(times, numbers, `TinyUSDZ, times of ${name}`);
}
for (const line of bad) console.log(`  ${line}`);
process.exit(bad.length ? 1 : 0);
