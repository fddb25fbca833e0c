// node three.mjs FILE.usda FILE.off UP SCALE ...: fails unless three.js reads from each .usda the
// triangles and the bounding box of the .off, whose axis UP points up, at SCALE metres a unit.
import { readFileSync } from "node:fs";
import { Box3, Vector3 } from "three";
import { USDLoader } from "three/addons/loaders/USDLoader.js";

function readOff(file) {
  const [, counts, ...lines] = readFileSync(file, "utf8").split("\n");
  const [vertices, faces] = counts.split(" ").map(Number);
  const box = new Box3();
  for (const line of lines.slice(0, vertices)) box.expandByPoint(new Vector3(...line.split(" ").map(Number)));
  let triangles = 0;
  for (const line of lines.slice(vertices, vertices + faces)) triangles += parseInt(line) - 2;
  return { triangles, box };
}

function readUsda(file) {
  const group = new USDLoader().parse(readFileSync(file, "utf8"));
  group.updateMatrixWorld(true);
  let triangles = 0;
  group.traverse((object) => {
    if (!object.isMesh) return;
    const { index, attributes } = object.geometry;
    triangles += (index ? index.count : attributes.position.count) / 3;
  });
  return { triangles, box: new Box3().setFromObject(group, true) };
}

const show = ({ triangles, box }) =>
  `${triangles} triangles, ${[...box.min, ...box.max].map((x) => x.toFixed(3)).join(" ")}`;

let bad = process.argv.length < 6;
for (let i = 2; i < process.argv.length; i += 4) {
  const [usda, off, up, scale] = process.argv.slice(i, i + 4);
  const truth = readOff(off);
  const { min, max } = truth.box;
  if (up === "z") truth.box.set(new Vector3(min.x, min.z, -max.y), new Vector3(max.x, max.z, -min.y));
  truth.box.min.multiplyScalar(Number(scale));
  truth.box.max.multiplyScalar(Number(scale));
  const found = readUsda(usda);
  const far = Math.max(found.box.min.distanceTo(truth.box.min), found.box.max.distanceTo(truth.box.max));
  console.log(`${usda}: ${show(found)}`);
  if (found.triangles === truth.triangles && far < 1e-3) continue;
  console.log(`  and not ${show(truth)}`);
  bad = true;
}
process.exit(bad ? 1 : 0);
