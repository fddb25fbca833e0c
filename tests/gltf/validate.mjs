// node validate.mjs MODULE FILE.glb...: fails unless Khronos's validator finds no error and no
// warning in any of the files.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const [module, ...files] = process.argv.slice(2);
const validator = createRequire(import.meta.url)(module);
console.log(`gltf-validator ${validator.version()}`);
let bad = files.length === 0;
for (const file of files) {
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(file)));
  const faults = issues.numErrors + issues.numWarnings;
  console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings`);
  if (faults > 0) {
    bad = true;
    for (const m of issues.messages.slice(0, 10)) console.log(`  ${m.code} ${m.pointer} ${m.message}`);
  }
}
process.exit(bad ? 1 : 0);
