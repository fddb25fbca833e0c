import * as THREE from "three";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const kFaces = ["face-x", "face+x", "face-y", "face+y", "face-z", "face+z"];
const kParallelLoads = 16;

/// Positions and normals of a file as floats of world space, counted from the index's origin. What
/// two chunks share has the same numbers in both, whatever each file counts from.
function worldAttributes(index, { geometry, matrixWorld }) {
  const { position, normal } = geometry.attributes;
  const { origin, up = "y", metres_per_unit: metres = 1 } = index;
  const back = ({ x, y, z }) => (up === "z" ? [x, -z, y] : [x, y, z]);
  const positions = new Float32Array(3 * position.count);
  const normals = new Float32Array(3 * position.count);
  const point = new THREE.Vector3();
  for (let i = 0; i < position.count; ++i) {
    point.fromBufferAttribute(position, i).applyMatrix4(matrixWorld);
    back(point).forEach((x, axis) => (positions[3 * i + axis] = x / metres - origin[axis]));
    normals.set(back(point.fromBufferAttribute(normal, i)), 3 * i);
  }
  return {
    position: new THREE.BufferAttribute(positions, 3),
    normal: new THREE.BufferAttribute(normals, 3),
  };
}

/// The meshes of chunks, loaded as they are asked for.
export class ChunkMeshes {
  constructor(index, url) {
    this.index = index;
    this.url = url;
    this.loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
    this.levels = index.chunks.map(() => []); // of each chunk by level; null while on its way
    this.queue = [];
    this.loading = 0;
  }

  /// Whether the mesh is here; if not, it is asked for.
  has(chunk, level) {
    const levels = this.levels[chunk];
    if (levels[level] === undefined) {
      levels[level] = null;
      this.queue.push([chunk, level]);
      this.pump();
    }
    return levels[level] !== null;
  }

  /// Meshes that are on their way.
  get pending() {
    return this.queue.length + this.loading;
  }

  /// Forgets the wishes that no load has begun for.
  forgetQueue() {
    for (const [chunk, level] of this.queue) this.levels[chunk][level] = undefined;
    this.queue = [];
  }

  pump() {
    while (this.loading < kParallelLoads && this.queue.length > 0) {
      const [chunk, level] = this.queue.shift();
      ++this.loading;
      this.load(chunk, level)
        .then((parts) => (this.levels[chunk][level] = parts))
        .catch((error) => {
          this.failure = error;
          console.error(error);
        })
        .finally(() => {
          --this.loading;
          this.pump();
        });
    }
  }

  async load(chunk, level) {
    const { file } = this.index.chunks[chunk].levels[level];
    if (!file) return { attributes: null, parts: {} };
    const response = await fetch(this.url + file);
    if (!response.ok) throw new Error(`${file}: ${response.status}`);
    const gltf = await this.loader.parseAsync(await response.arrayBuffer(), "");
    let attributes = null;
    const parts = {};
    gltf.scene.updateMatrixWorld();
    gltf.scene.traverse((object) => {
      if (!object.geometry) return;
      attributes ??= worldAttributes(this.index, object); // all primitives share them
      parts[object.geometry.userData.name] = object.geometry.index.array;
    });
    return { attributes, parts };
  }

  /// What to draw of a chunk at a level: its interior, and for each face the strip that the mask
  /// says. Groups 0, 1 and 2 are the interior, the regular strips and those to coarser chunks.
  geometry(chunk, level, mask) {
    const { attributes, parts } = this.levels[chunk][level];
    const geometry = new THREE.BufferGeometry();
    if (!attributes) return geometry;
    const isCoarser = (face) => (mask >> face) & 1;
    const groups = [
      ["interior"],
      kFaces.filter((_, face) => !isCoarser(face)).map((face) => `${face}.regular`),
      kFaces.filter((_, face) => isCoarser(face)).map((face) => `${face}.transition`),
    ].map((names) => names.map((name) => parts[name]).filter(Boolean));
    const count = groups.flat().reduce((sum, part) => sum + part.length, 0);
    const indices = new (attributes.position.count > 65535 ? Uint32Array : Uint16Array)(count);
    let end = 0;
    groups.forEach((group, material) => {
      const begin = end;
      for (const part of group) {
        indices.set(part, end);
        end += part.length;
      }
      geometry.addGroup(begin, end - begin, material);
    });
    for (const name in attributes) geometry.setAttribute(name, attributes[name]);
    geometry.setIndex(new THREE.BufferAttribute(indices, 1));
    return geometry;
  }
}
