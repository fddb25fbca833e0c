// node server.mjs FOLDER [PORT]: shows the chunks of a folder at http://127.0.0.1:PORT/. Serves the
// files beside this one and, below /chunks/, those of FOLDER; to this machine alone.
import { createReadStream, realpathSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, sep } from "node:path";
import { pipeline } from "node:stream";
import { fileURLToPath } from "node:url";

const kTypes = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".json": "application/json",
  ".glb": "model/gltf-binary",
};

/// The file that a request names, if it lies in one of the two folders.
function fileOf(url, folder) {
  const path = decodeURIComponent(new URL(url, "http://localhost").pathname);
  const own = dirname(fileURLToPath(import.meta.url));
  const [root, rest] = path.startsWith("/chunks/") ? [folder, path.slice(7)] : [own, path];
  const file = realpathSync(join(root, rest === "/" ? "index.html" : rest));
  const inside = file.startsWith(realpathSync(root) + sep);
  return inside && statSync(file).isFile() ? file : null;
}

/// Whether a request is meant for this server: a page of another host, whose name was made to lead
/// here, may not read what it serves.
function isMeant(request) {
  const { port } = request.socket.address();
  return [`127.0.0.1:${port}`, `localhost:${port}`].includes(request.headers.host);
}

/// Serves a folder of chunks; gives the server once it listens. Port 0 stands for any free one.
export function serve(folder, port) {
  const server = createServer((request, response) => {
    if (!isMeant(request)) {
      response.writeHead(403).end("for this machine alone\n");
      return;
    }
    try {
      const file = fileOf(request.url, folder);
      if (!file) throw new Error("outside");
      const stream = createReadStream(file);
      stream.once("open", () => {
        response.writeHead(200, {
          "content-type": kTypes[extname(file)] ?? "application/octet-stream",
          "cache-control": "no-cache",
        });
      });
      // A file that cannot be opened or read on, or a reader that goes away, ends this answer alone.
      pipeline(stream, response, (error) => {
        if (error && !response.headersSent) response.writeHead(404).end("not found\n");
      });
    } catch {
      response.writeHead(404).end("not found\n");
    }
  });
  return new Promise((resolve, reject) => {
    server.once("error", reject);
    server.listen(port, "127.0.0.1", () => resolve(server));
  });
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [folder, port = "8080"] = process.argv.slice(2);
  if (!folder) {
    console.error("usage: node server.mjs FOLDER [PORT]");
    process.exit(2);
  }
  const server = await serve(folder, Number(port));
  console.log(`http://127.0.0.1:${server.address().port}/`);
}
