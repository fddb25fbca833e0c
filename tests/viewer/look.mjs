// node look.mjs VIEWER CHUNKS PART TUFA CHROMIUM FOLDER: opens two folders of chunks in the viewer, a
// part and the ground, goes from one to the other, looks down onto the ground from some places, and
// fails if the background shows through, or if the levels are others than the command's. Leaves
// pictures in FOLDER.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import { basename, join } from "node:path";
import { pathToFileURL } from "node:url";

const [viewer, chunks, part, tufa, chromium, folder] = process.argv.slice(2);
const puppeteer = createRequire(join(viewer, "package.json"))("puppeteer-core");
const { serve } = await import(pathToFileURL(join(viewer, "server.mjs")));

const kWidth = 960;
const kHeight = 540;
const kErrorSlider = 1.6; // 3 pixels: so much that cracks could not be missed

const server = await serve([chunks, part], 0);
const browser = await puppeteer.launch({
  executablePath: chromium,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  defaultViewport: { width: kWidth, height: kHeight },
  protocolTimeout: 600000,
});

/// Pixels of a picture in the colour of the background, or mixed with it.
function countLoudPixels(page, png) {
  return page.evaluate(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    let loud = 0;
    for (let i = 0; i < data.length; i += 4) {
      if (data[i] > data[i + 1] + 40 && data[i + 2] > data[i + 1] + 40) ++loud;
    }
    return loud;
  }, Buffer.from(png).toString("base64"));
}

const twoFrames = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/// Waits until all meshes that the camera asks for are drawn.
async function settle(page) {
  await page.waitForFunction("viewer.meshes.failure || viewer.settled", { timeout: 300000 });
  assert.equal(await page.evaluate("viewer.meshes.failure?.message ?? null"), null);
  await twoFrames(page);
}

async function look(page, eye, target) {
  await page.evaluate((from, to) => viewer.look(from, to), eye, target);
  // One frame, so that the viewer has asked for what it wants there.
  await twoFrames(page);
  await settle(page);
}

const setPanel = (page, visible) =>
  page.evaluate((on) => (document.getElementById("panel").style.display = on ? "" : "none"), visible);

/// The same of what is drawn from now on.
async function countLoud(page) {
  await twoFrames(page);
  return countLoudPixels(page, await page.screenshot());
}

try {
  const page = await browser.newPage();
  const address = `http://127.0.0.1:${server.address().port}/`;
  const names = [basename(chunks), basename(part)];
  await page.goto(`${address}?scene=none`);
  await page.waitForFunction("document.getElementById('figures').textContent.includes('404')");

  const faults = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("requestfailed", (request) => faults.push(request.url()));
  await page.goto(`${address}?${new URLSearchParams({ scene: names[1] })}`);
  await page.waitForFunction("window.viewer", { timeout: 60000 });
  await settle(page);
  await page.screenshot({ path: join(folder, "part.png") });
  // The names are shown as they are, whatever they hold.
  const options = await page.$$eval("#scene > option", (all) => all.map((one) => one.innerText));
  assert.deepEqual(options, names);
  assert.equal(await page.$eval("#scene", (menu) => menu.value), names[1]);
  assert.equal(await page.$("#scene > option > *"), null);

  await Promise.all([page.waitForNavigation(), page.select("#scene", names[0])]);
  await page.waitForFunction("window.viewer", { timeout: 60000 });
  const pixelError = await page.evaluate((value) => {
    const slider = document.getElementById("error");
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
    return viewer.pixelError;
  }, kErrorSlider);
  await settle(page);
  await page.screenshot({ path: join(folder, "start.png") });
  const index = await page.evaluate("viewer.index");
  assert.ok(index.chunks.length >= 1000, `${index.chunks.length} chunks`);
  console.log(`${index.chunks.length} chunks`);

  // The ground fills the picture: its edges are at 1 and -1.
  const top = Math.max(...index.chunks.map(({ levels }) => levels[0].bounds.max[2]));
  const places = [
    { eye: [0, -0.75, top + 0.12], target: [0, -0.62, top] },
    { eye: [-0.7, -0.2, top + 0.15], target: [-0.6, -0.16, top] },
    { eye: [0.3, 0.6, top + 0.3], target: [0.2, 0.4, top] },
  ];
  await setPanel(page, false);
  for (const [number, { eye, target }] of places.entries()) {
    await look(page, eye, target);
    const lods = await page.evaluate("viewer.drawn");
    assert.ok(new Set(lods).size >= 3, "levels in the picture");
    const png = await page.screenshot({ path: join(folder, `ground${number}.png`) });
    const loud = await countLoudPixels(page, png);
    console.log(`from ${eye}: ${loud} loud pixels, levels ${[0, 1, 2, 3].map((k) => lods.filter((lod) => lod === k).length)}`);
    assert.equal(loud, 0, "the background shows through the ground");

    // The same levels as the library's.
    const error = (pixelError * 1080) / kHeight;
    const report = JSON.parse(
      execFileSync(tufa, ["chunks", "--assemble", chunks, "--lods", `camera:${eye}`, "--pixel-error",
        `${error}`, "-o", join(folder, "seen.ply"), "--json"], { maxBuffer: 1 << 28 }),
    );
    assert.deepEqual(lods, report.lods, "levels chosen by the page and by the command");
  }

  // That nothing loud was seen means something only if cracks and holes are seen.
  await page.evaluate("viewer.set('masks', false)");
  const cracks = await countLoud(page);
  await page.evaluate("viewer.set('masks', true)");
  assert.equal(await countLoud(page), 0);
  await page.evaluate("viewer.objects.forEach((o, i) => (o.visible = i % 7 !== 0))");
  const holes = await countLoud(page);
  console.log(`${cracks} loud pixels without transition strips, ${holes} without every seventh chunk`);
  assert.ok(cracks > 0, "no crack is seen without transition strips");
  assert.ok(holes > 1000, "no hole is seen without every seventh chunk");
  await page.evaluate("viewer.objects.forEach((o) => (o.visible = o.geometry.index !== null))");

  await setPanel(page, true);
  await look(page, places[0].eye, places[0].target);
  await page.evaluate(() => new Promise((done) => setTimeout(done, 1000)));
  await page.screenshot({ path: join(folder, "viewer.png") });
  await page.click("#strips");
  await page.click("#wireframe");
  await page.evaluate(() => new Promise((done) => setTimeout(done, 2000)));
  await page.screenshot({ path: join(folder, "strips.png") });
  console.log(await page.evaluate("document.getElementById('figures').textContent"));
  assert.deepEqual(faults, []);
} finally {
  await browser.close();
  server.close();
}
