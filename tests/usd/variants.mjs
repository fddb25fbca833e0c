// node variants.mjs LODS.usda MESH.usda: fails unless TinyUSDZ, which the loader of three.js has no
// part in, reads both, and of the variants the one chosen: with the faces of the other file.
import { readFileSync } from "node:fs";

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

function facesOf(file) {
  const loader = new module.TinyUSDZLoaderNative();
  const read = loader.loadAsLayerFromBinary(new Uint8Array(readFileSync(file)), file);
  if (!read) throw new Error(loader.error());
  loader.composeVariants();
  loader.layerToRenderScene();
  if (loader.numMeshes() !== 1) throw new Error(`${file}: ${loader.numMeshes()} meshes, not 1`);
  const mesh = loader.getMesh(0);
  console.log(`${file}: ${mesh.absPath}, ${mesh.faceVertexCounts.length} faces`);
  return mesh.faceVertexIndices.join(" ");
}

const [lods, mesh] = process.argv.slice(2).map(facesOf);
process.exit(lods === mesh ? 0 : 1);
