// node server.mjs FOLDER... [--port PORT]: shows the chunks of each folder as a scene at
// http://127.0.0.1:PORT/. Serves the files beside this one, the names of the scenes as /scenes.json
// and the files of a scene below /chunks/NAME/; to this machine alone.
import { createReadStream, existsSync, realpathSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, sep } from "node:path";
import { pipeline } from "node:stream";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { nameFolders } from "./scenes.mjs";

const kOwnFolder = dirname(fileURLToPath(import.meta.url));
const kTypes = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".json": "application/json",
  ".glb": "model/gltf-binary",
};

/// The file that a path names, if it lies in the folder of its scene or in the viewer's own.
function fileOf(path, scenes) {
  const [, first, name, ...rest] = path.split("/");
  const [root, inner] =
    first === "chunks" ? [scenes.get(name), rest.join("/")] : [kOwnFolder, path];
  if (root === undefined) return null;
  const file = realpathSync(join(root, path === "/" ? "index.html" : inner));
  const inside = file.startsWith(realpathSync(root) + sep);
  return inside && statSync(file).isFile() ? file : null;
}

/// Whether a request is meant for this server: a page of another host, whose name was made to lead
/// here, may not read what it serves.
function isMeant(request) {
  const { port } = request.socket.address();
  return [`127.0.0.1:${port}`, `localhost:${port}`].includes(request.headers.host);
}

/// The head of an answer with a file of this ending.
const headOf = (ending) => ({
  "content-type": kTypes[ending] ?? "application/octet-stream",
  "cache-control": "no-cache",
});

function sendFile(file, response) {
  const stream = createReadStream(file);
  stream.once("open", () => response.writeHead(200, headOf(extname(file))));
  // A file that cannot be opened or read on, or a reader that goes away, ends this answer alone.
  pipeline(stream, response, (error) => {
    if (error && !response.headersSent) response.writeHead(404).end("not found\n");
  });
}

/// Serves folders of chunks; gives the server once it listens. Port 0 stands for any free one.
export function serve(folders, port) {
  const scenes = nameFolders(folders);
  const server = createServer((request, response) => {
    if (!isMeant(request)) {
      response.writeHead(403).end("for this machine alone\n");
      return;
    }
    try {
      const path = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
      if (path === "/scenes.json") {
        response.writeHead(200, headOf(".json")).end(JSON.stringify([...scenes.keys()]));
        return;
      }
      const file = fileOf(path, scenes);
      if (!file) throw new Error("outside");
      sendFile(file, response);
    } catch {
      response.writeHead(404).end("not found\n");
    }
  });
  return new Promise((resolve, reject) => {
    server.once("error", reject);
    server.listen(port, "127.0.0.1", () => resolve(server));
  });
}

/// Folders and port of the command line.
function readArguments() {
  const options = { port: { type: "string", default: "8080" } };
  const { values, positionals: folders } = parseArgs({ options, allowPositionals: true });
  if (folders.length === 0) throw new Error("no folder");
  const strange = folders.find((folder) => !existsSync(join(folder, "chunks.json")));
  if (strange !== undefined) throw new Error(`${strange} has no chunks.json`);
  return { folders, port: Number(values.port) };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  try {
    const { folders, port } = readArguments();
    const server = await serve(folders, port);
    console.log(`http://127.0.0.1:${server.address().port}/`);
  } catch (error) {
    console.error(`${error.message}\nusage: node server.mjs FOLDER... [--port PORT]`);
    process.exit(2);
  }
}
