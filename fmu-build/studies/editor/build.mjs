// Bundles the editor, and puts the licences of all that is in it next to it.
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";

const out = new URL("../src/live/page/editor/", import.meta.url).pathname;
const made = await build({
  entryPoints: ["index.js"], bundle: true, minify: true, format: "iife", globalName: "CodeMirror", target: "es2020",
  legalComments: "none", metafile: true, write: false,
});
const packages = [...new Set(Object.keys(made.metafile.inputs).map((path) => path.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)\//)?.[1]).filter(Boolean))].sort();
const [owners, texts, versions] = [new Set(), new Set(), []];
for (const name of packages) {
  const about = JSON.parse(readFileSync(`node_modules/${name}/package.json`, "utf8"));
  versions.push(`${name} ${about.version}`);
  const licence = readFileSync(`node_modules/${name}/LICENSE`, "utf8");
  owners.add(licence.match(/^Copyright .*$/m)[0].trim());
  texts.add(licence.replace(/^Copyright .*$/m, "").replace(/^MIT License/, "").trim().replace(/\s+/g, " "));
}
if (texts.size !== 1) throw new Error(`${texts.size} licences instead of one`);
const text = readFileSync("node_modules/@codemirror/state/LICENSE", "utf8").replace(/^Copyright .*$/m, [...owners].sort().join("\n"));
writeFileSync(`${out}LICENSE`, text);
writeFileSync(`${out}editor.min.js`, `/*! CodeMirror: ${versions.join(", ")}\n${text}*/\n${made.outputFiles[0].text}`);
console.log(`${versions.length} packages, ${made.outputFiles[0].text.length} bytes`);
