// Which level each chunk is drawn at: what tufa::selectLods() and tufa::transitionMask() do, on
// the plain data of chunks.json.

const boxes = new WeakMap(); // chunk -> corners of the box around all its levels

export function boxOf(chunk) {
  if (!boxes.has(chunk)) {
    const levels = chunk.levels.filter(({ vertices }, level) => level === 0 || vertices > 0);
    const corner = (name, choose) =>
      [0, 1, 2].map((axis) => choose(...levels.map(({ bounds }) => bounds[name][axis])));
    boxes.set(chunk, { min: corner("min", Math.min), max: corner("max", Math.max) });
  }
  return boxes.get(chunk);
}

/// The distance from a point to the box of a chunk; 0 inside.
function distanceTo(chunk, eye) {
  const { min, max } = boxOf(chunk);
  const beyond = (axis) => Math.max(min[axis] - eye[axis], 0, eye[axis] - max[axis]);
  return Math.hypot(beyond(0), beyond(1), beyond(2));
}

/// Lowers levels, in place, until neighbours differ by at most one.
export function restrictLods(index, lods) {
  // Not Math.max(...lods): there may be more chunks than a call takes arguments.
  const coarsest = lods.reduce((most, lod) => Math.max(most, lod), 0);
  for (let level = 0; level + 1 < coarsest; ++level) {
    for (let chunk = 0; chunk < lods.length; ++chunk) {
      if (lods[chunk] !== level) continue;
      for (const other of index.chunks[chunk].neighbours) {
        if (other >= 0) lods[other] = Math.min(lods[other], level + 1);
      }
    }
  }
}

/// For each chunk the coarsest level whose certified error is seen under at most `pixelError`
/// pixels. `camera`: { eye, verticalAngle (radians), screenHeight }, eye in world space.
export function selectLods(index, camera, pixelError) {
  const pixel = (2 * Math.tan(camera.verticalAngle / 2)) / camera.screenHeight;
  const lods = index.chunks.map((chunk) => {
    const most = (pixelError * pixel * distanceTo(chunk, camera.eye)) / index.voxel_size;
    let lod = 0;
    for (let i = 1; i < chunk.levels.length; ++i) {
      if (chunk.levels[i].max_error_voxels <= most) lod = i;
    }
    return lod;
  });
  restrictLods(index, lods);
  return lods;
}

/// A bit for each face (-x, +x, -y, +y, -z, +z) whose neighbour is drawn at a coarser level.
export function transitionMask(index, chunk, lods) {
  return index.chunks[chunk].neighbours.reduce(
    (mask, other, face) => (other >= 0 && lods[other] > lods[chunk] ? mask | (1 << face) : mask),
    0,
  );
}
