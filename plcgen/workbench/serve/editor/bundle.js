// Bundles CodeMirror for the page, and puts the licences of everything in the bundle beside it.
import { build } from "esbuild";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const target = process.argv[2];
const done = await build({
  entryPoints: ["editor.js"], bundle: true, format: "esm", minify: true, legalComments: "none", metafile: true,
  target: ["chrome111", "firefox115", "safari16"], outfile: join(target, "codemirror.bundle.js"),
});
const packages = new Set(Object.keys(done.metafile.inputs).map((file) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(file)?.[1]).filter(Boolean));
const texts = [...packages].sort().map((name) => {
  const room = join("node_modules", name);
  const { version, license } = JSON.parse(readFileSync(join(room, "package.json"), "utf8"));
  const file = readdirSync(room).find((one) => /^licen[cs]e/i.test(one));
  return `${name} ${version} (${license})\n\n${readFileSync(join(room, file), "utf8").trim()}\n`;
});
writeFileSync(join(target, "codemirror.licences.txt"), texts.join("\n----\n\n"));
