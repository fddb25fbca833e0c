// node lods.test.mjs VIEWER: levels are chosen however many chunks there are.
import assert from "node:assert/strict";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [viewer] = process.argv.slice(2);
const { restrictLods } = await import(pathToFileURL(join(viewer, "lods.js")));

// A row of more chunks than a call takes arguments.
const kChunks = 300000;
const chunks = Array.from({ length: kChunks }, (_, i) => ({
  neighbours: [i - 1, i + 1 < kChunks ? i + 1 : -1, -1, -1, -1, -1],
}));
const lods = chunks.map((_, i) => (i === 0 ? 0 : 3));
restrictLods({ chunks }, lods);
assert.deepEqual(lods.slice(0, 5), [0, 1, 2, 3, 3]);
assert.equal(lods[kChunks - 1], 3);

const none = [];
restrictLods({ chunks: [] }, none);
assert.deepEqual(none, []);
