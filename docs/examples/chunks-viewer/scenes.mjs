import { basename, resolve } from "node:path";

/// A name for each folder, by which its scene is asked for: the folder's own, and for a second one of
/// the same name with a number.
export function nameFolders(folders) {
  const scenes = new Map();
  for (const folder of folders) {
    const own = basename(resolve(folder));
    let name = own;
    for (let number = 2; scenes.has(name); ++number) name = `${own} ${number}`;
    scenes.set(name, folder);
  }
  return scenes;
}
