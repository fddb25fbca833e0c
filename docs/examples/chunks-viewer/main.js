import { FrameTime } from "./frame_time.js";
import { connectPanel, offerScenes, panelBox, showFigures } from "./panel.js";
import { Viewer } from "./viewer.js";

async function load(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status}`);
  return response.json();
}

/// The scene that the address asks for, or the first.
async function openScene() {
  const names = await load("scenes.json");
  const name = new URLSearchParams(location.search).get("scene") ?? names[0];
  offerScenes(names, name);
  const url = `chunks/${encodeURIComponent(name)}/`;
  const index = await load(`${url}chunks.json`);
  if (index.tufa_chunks !== 1) throw new Error(`chunks.json of version ${index.tufa_chunks}`);
  return new Viewer(index, url);
}

function run(viewer) {
  const frame = new FrameTime();
  let before = performance.now();
  let shown = 0;
  viewer.renderer.setAnimationLoop((now) => {
    const elapsed = Math.max(0, now - before);
    before = now;
    frame.add(elapsed);
    viewer.fly.move(Math.min(elapsed, 100) / 1000);
    viewer.update();
    viewer.render();
    if (now - shown < 250) return;
    shown = now;
    showFigures(viewer.figures(frame.milliseconds));
  });
}

try {
  const viewer = await openScene();
  connectPanel(viewer);
  viewer.seeAll(panelBox());
  run(viewer);
  window.viewer = viewer; // for the console
} catch (error) {
  showFigures(error.message);
  throw error;
}
