// node server.test.mjs VIEWER FOLDER: what the viewer's server answers, and what it refuses.
import assert from "node:assert/strict";
import { chmodSync, mkdirSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { request } from "node:http";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [viewer, folder] = process.argv.slice(2);
const { serve } = await import(pathToFileURL(join(viewer, "server.mjs")));

rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
writeFileSync(join(folder, "chunks.json"), "{}");
writeFileSync(join(folder, "large.glb"), Buffer.alloc(1 << 24));
symlinkSync("/etc/passwd", join(folder, "link.glb"));
const server = await serve(folder, 0);
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

assert.deepEqual(await ask("/chunks/chunks.json"), { status: 200, text: "{}" });
assert.equal((await ask("/", `localhost:${port}`)).status, 200);
for (const path of ["/chunks/none.glb", "/chunks/", "/chunks/link.glb", "/chunks/%00", "/%ff",
                    "/chunks/..%2f..%2fetc/passwd", "/../../etc/passwd"]) {
  assert.equal((await ask(path)).status, 404, path);
}

// A page of another host, whose name was made to lead here.
for (const host of ["evil.example", `evil.example:${port}`, "127.0.0.1", "localhost:1"]) {
  assert.equal((await ask("/chunks/chunks.json", host)).status, 403, host);
}

// A file that cannot be opened ends the answer, not the server; root may open all.
writeFileSync(join(folder, "secret.glb"), "");
chmodSync(join(folder, "secret.glb"), 0);
assert.ok([404, 200].includes((await ask("/chunks/secret.glb")).status));

// Nor does a reader that goes away in the middle.
await new Promise((done) => {
  const asked = request({ port, path: "/chunks/large.glb" }, (response) => {
    response.once("data", () => asked.destroy());
    response.on("error", () => {});
    response.on("close", done);
  });
  asked.on("error", () => {}).end();
});
assert.equal((await ask("/chunks/chunks.json")).status, 200);
server.close();
server.closeAllConnections();
