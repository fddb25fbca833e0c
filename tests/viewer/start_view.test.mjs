// node start_view.test.mjs VIEWER: from where the viewer begins, all of a thing is seen, and it fills
// the room that the panel leaves.
import assert from "node:assert/strict";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [viewer] = process.argv.slice(2);
const { startEye } = await import(pathToFileURL(join(viewer, "start_view.js")));

const kTangent = Math.tan(Math.PI / 8);
const kPanel = { right: 400, bottom: 260 };
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);

// Right, up and back of a camera that looks down by 30 degrees, askew.
const [c, s] = [Math.cos(Math.PI / 6), Math.sin(Math.PI / 6)];
const kAxes = [[0.8, 0.6, 0], [-0.6 * s, 0.8 * s, c], [0.6 * c, -0.8 * c, s]];

const boxOfSize = (size, centre) =>
  [0, 1, 2, 3, 4, 5, 6, 7].map((corner) =>
    centre.map((x, axis) => x + size[axis] * (((corner >> axis) & 1) - 0.5)));

/// The box in the window, in pixels, of what an eye sees.
function seen(points, eye, { width, height }) {
  const pixels = points.map((point) => {
    const [x, y, z] = kAxes.map((axis) => dot(axis, point.map((p, i) => p - eye[i])));
    assert.ok(z < 0, "in front of the eye");
    const unit = height / (2 * kTangent * -z);
    return [width / 2 + x * unit, height / 2 - y * unit];
  });
  const [xs, ys] = [0, 1].map((axis) => pixels.map((pixel) => pixel[axis]));
  return { left: Math.min(...xs), right: Math.max(...xs), top: Math.min(...ys),
           bottom: Math.max(...ys) };
}

const things = { ground: [20, 20, 2], part: [1, 1, 1], pole: [0.1, 0.1, 30], beam: [50, 1, 1],
                 sheet: [3, 0, 5] };
const windows = [[1280, 720], [2560, 720], [1000, 600], [600, 1200], [500, 500], [300, 200]];
for (const [name, size] of Object.entries(things)) {
  const points = boxOfSize(size, [7, -3, 11]);
  for (const [width, height] of windows) {
    const what = `${name} in ${width} x ${height}`;
    const window = { width, height, panel: kPanel };
    const { left, right, top, bottom } = seen(points, startEye(points, kAxes, kTangent, window), window);
    assert.ok(left > 0 && right < width && top > 0 && bottom < height, `${what}: in sight`);
    const beside = left > kPanel.right;
    const below = top > kPanel.bottom;
    if (width >= 600) assert.ok(beside || below, `${what}: not behind the panel`);
    if (name === "part" && width > 2 * height) assert.ok(beside, `${what}: where it is largest`);
    // It reaches from one margin to the other across or upright.
    const free = [[beside ? kPanel.right : 0, width], [below ? kPanel.bottom : 0, height]];
    const room = free.map(([begin, end]) => end - begin);
    assert.ok(right - left > room[0] - 50 || bottom - top > room[1] - 50, `${what}: large`);
  }
}
