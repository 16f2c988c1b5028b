// Bundles the page into one file: node build.mjs SCENES OUT.html
// Run by `cargo xtask page`, beside `node_modules` and `core/`, the modules with their JavaScript.
import { build } from "esbuild";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { gzipSync } from "node:zlib";

const [scenes, out] = process.argv.slice(2);
const options = { bundle: true, minify: true, format: "iife", target: "es2022", legalComments: "inline", write: false, logLevel: "warning" };

/** Shipped scenes by name. A machine in a file of its own is that of another one of them. */
function shipped() {
    const found = {};
    for (const folder of [scenes, join(scenes, "paths"), join(scenes, "design"), join(scenes, "inputs")]) {
        for (const file of readdirSync(folder).filter((file) => file.endsWith(".toml"))) {
            found[basename(file, ".toml")] = readFileSync(join(folder, file), "utf8");
        }
    }
    return found;
}

const scripts = await build({ ...options, entryPoints: ["src/main.ts"], define: { SCENES: JSON.stringify(shipped()) } });
// An end tag would end the script of the page.
const main = scripts.outputFiles[0].text.replaceAll("</script", "<\\/script");
const styles = await build({ ...options, entryPoints: ["src/style.css"] });
const style = styles.outputFiles[0].text;
const [core, drawings, board] = ["core", "drawing", "board"].map((name) => ({ module: readFileSync(`core/${name}_bg.wasm`), compressed: readFileSync(`core/${name}.lzma`) }));
const licence = readFileSync("node_modules/uplot/LICENSE", "utf8").trim();

const page = readFileSync("index.html", "utf8")
    .replace("<!--licence-->", () => `<!--\nuPlot, https://github.com/leeoniya/uPlot:\n${licence}\n-->`)
    .replace("/*style*/", () => style)
    .replace("/*core*/", () => core.compressed.toString("base64"))
    .replace("/*drawings*/", () => drawings.compressed.toString("base64"))
    .replace("/*board*/", () => board.compressed.toString("base64"))
    .replace("/*main*/", () => main);
writeFileSync(out, page);
const kilobytes = (bytes) => `${(bytes / 1000).toFixed(0)} kB`;
const zipped = (bytes) => kilobytes(gzipSync(bytes, { level: 9 }).length);
const sizes = ({ module, compressed }) => `${kilobytes(module.length)}, ${kilobytes(compressed.length)} compressed by LZMA, ${zipped(module)} by gzip`;
console.log(`module ${sizes(core)}`);
console.log(`reader of drawings ${sizes(drawings)}`);
console.log(`module for boards ${sizes(board)}`);
console.log(`page ${kilobytes(Buffer.byteLength(page))}, ${zipped(page)} compressed by gzip`);
