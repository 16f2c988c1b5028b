// Bundles the page into one file: node build.mjs SCENES OUT.html
// Run by `cargo xtask page`, beside `node_modules` and `core/`, the modules with their JavaScript.
import { build } from "esbuild";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { gzipSync } from "node:zlib";

const [scenes, out] = process.argv.slice(2);
const options = { bundle: true, minify: true, format: "iife", target: "es2022", legalComments: "inline", write: false, logLevel: "warning" };

/** Shipped scenes by name; those with a machine in a file of its own are left out: the page has no files. */
function shipped() {
    const found = {};
    for (const folder of [scenes, join(scenes, "paths"), join(scenes, "design")]) {
        for (const file of readdirSync(folder).filter((file) => file.endsWith(".toml"))) {
            const text = readFileSync(join(folder, file), "utf8");
            if (!/^machine =/m.test(text)) found[basename(file, ".toml")] = text;
        }
    }
    return found;
}

const scripts = await build({ ...options, entryPoints: ["src/main.ts"], define: { SCENES: JSON.stringify(shipped()) } });
// An end tag would end the script of the page.
const main = scripts.outputFiles[0].text.replaceAll("</script", "<\\/script");
const styles = await build({ ...options, entryPoints: ["src/style.css"] });
const style = styles.outputFiles[0].text;
const packed = (module) => gzipSync(module, { level: 9 }).toString("base64");
const module = readFileSync("core/core_bg.wasm");
const board = readFileSync("core/board_bg.wasm");
const licence = readFileSync("node_modules/uplot/LICENSE", "utf8").trim();

const page = readFileSync("index.html", "utf8")
    .replace("<!--licence-->", () => `<!--\nuPlot, https://github.com/leeoniya/uPlot:\n${licence}\n-->`)
    .replace("/*style*/", () => style)
    .replace("/*core*/", () => packed(module))
    .replace("/*board*/", () => packed(board))
    .replace("/*main*/", () => main);
writeFileSync(out, page);
const kilobytes = (bytes) => `${(bytes / 1000).toFixed(0)} kB`;
console.log(`module ${kilobytes(module.length)}, ${kilobytes(gzipSync(module, { level: 9 }).length)} compressed`);
console.log(`module for boards ${kilobytes(board.length)}, ${kilobytes(gzipSync(board, { level: 9 }).length)} compressed`);
console.log(`page ${kilobytes(Buffer.byteLength(page))}, ${kilobytes(gzipSync(page, { level: 9 }).length)} compressed`);
