// node server.test.mjs VIEWER FOLDER: what the viewer's server answers, and what it refuses.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { chmodSync, mkdirSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { request } from "node:http";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [viewer, folder] = process.argv.slice(2);
const { serve } = await import(pathToFileURL(join(viewer, "server.mjs")));

rmSync(folder, { recursive: true, force: true });
const terrain = join(folder, "terrain");
const other = join(folder, "other", "terrain"); // the same name twice
const strange = join(folder, "<b>&'50%25\"?#");
for (const path of [terrain, other, strange]) mkdirSync(path, { recursive: true });
writeFileSync(join(terrain, "chunks.json"), "{}");
writeFileSync(join(other, "chunks.json"), "[2]");
writeFileSync(join(strange, "chunks.json"), "[3]");
writeFileSync(join(folder, "chunks.json"), "beside the scenes");
writeFileSync(join(terrain, "large.glb"), Buffer.alloc(1 << 24));
symlinkSync("/etc/passwd", join(terrain, "link.glb"));
symlinkSync(join(other, "chunks.json"), join(terrain, "link.json"));
const server = await serve([terrain, `${other}/`, strange], 0);
const { port } = server.address();

/// The status and the text of an answer.
function ask(path, host = `127.0.0.1:${port}`) {
  return new Promise((resolve, reject) => {
    const asked = request({ port, path, headers: { host } }, (response) => {
      let text = "";
      response.on("data", (part) => (text += part));
      response.on("end", () => resolve({ status: response.statusCode, text }));
    });
    asked.on("error", reject).end();
  });
}

// Each folder is a scene, with a name of its own.
const names = JSON.parse((await ask("/scenes.json")).text);
assert.deepEqual(names, ["terrain", "terrain 2", "<b>&'50%25\"?#"]);
for (const [number, text] of ["{}", "[2]", "[3]"].entries()) {
  const path = `/chunks/${encodeURIComponent(names[number])}/chunks.json`;
  assert.deepEqual(await ask(path), { status: 200, text }, path);
}
assert.equal((await ask("/", `localhost:${port}`)).status, 200);
assert.equal((await ask("/?scene=none")).status, 200);
for (const path of ["/chunks/none/chunks.json", "/chunks/chunks.json", "/chunks//chunks.json",
                    "/chunks/__proto__/chunks.json", "/chunks/", "/chunks", "/chunks/terrain",
                    "/chunks/terrain/", "/chunks/terrain/none.glb", "/chunks/terrain/link.glb",
                    "/chunks/terrain/link.json", "/chunks/terrain/..%2fchunks.json",
                    "/chunks/terrain/..%2fother%2fterrain%2fchunks.json",
                    "/chunks/..%2fchunks.json", "/chunks/terrain/%00", "/%ff",
                    "/chunks/terrain/..%2f..%2f..%2fetc/passwd", "/../../etc/passwd"]) {
  assert.equal((await ask(path)).status, 404, path);
}

// A page of another host, whose name was made to lead here.
for (const host of ["evil.example", `evil.example:${port}`, "127.0.0.1", "localhost:1"]) {
  assert.equal((await ask("/chunks/terrain/chunks.json", host)).status, 403, host);
  assert.equal((await ask("/scenes.json", host)).status, 403, host);
}

// A file that cannot be opened ends the answer, not the server; root may open all.
writeFileSync(join(terrain, "secret.glb"), "");
chmodSync(join(terrain, "secret.glb"), 0);
assert.ok([404, 200].includes((await ask("/chunks/terrain/secret.glb")).status));

// Nor does a reader that goes away in the middle.
await new Promise((done) => {
  const asked = request({ port, path: "/chunks/terrain/large.glb" }, (response) => {
    response.once("data", () => asked.destroy());
    response.on("error", () => {});
    response.on("close", done);
  });
  asked.on("error", () => {}).end();
});
assert.equal((await ask("/chunks/terrain/chunks.json")).status, 200);
server.close();
server.closeAllConnections();

// What the command refuses.
for (const [words, fault] of [[[], /no folder/], [[join(folder, "other")], /has no chunks.json/],
                              [[terrain, "--port", "many"], /port/i], [["--prot", "1"], /--prot/]]) {
  const { code, stderr } = await new Promise((done) => {
    execFile(process.execPath, [join(viewer, "server.mjs"), ...words], (error, _, text) =>
      done({ code: error?.code, stderr: text }));
  });
  assert.equal(code, 2, words.join(" "));
  assert.match(stderr, fault);
  assert.match(stderr, /usage: /);
}
