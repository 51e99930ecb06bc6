// SPDX-License-Identifier: BSD-3-Clause
// Makes the page without data as a C++ source: node build.mjs TOOLS OUT.cpp OUT.html [ENGINE.wasm]
// TOOLS is the folder whose node_modules have three and esbuild.
import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const [tools, cpp, html, wasm] = process.argv.slice(2), here = dirname(fileURLToPath(import.meta.url));
const modules = resolve(tools, "node_modules"), require = createRequire(join(modules, "x.js")), esbuild = require("esbuild");

const bundle = (options) => esbuild.buildSync({ bundle: true, minify: true, write: false, charset: "ascii", logLevel: "error", nodePaths: [modules],
	target: ["chrome94", "firefox113", "safari16.4"], legalComments: "none", ...options }).outputFiles[0].text;
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const escape = (text) => text.replace(/[&<]|[^\x00-\x7f]/gu, (c) => `&#${c.codePointAt(0)};`);

const script = bundle({ entryPoints: [join(here, "main.js")], format: "esm" }), style = bundle({ entryPoints: [join(here, "style.css")] });
const policy = `default-src 'none'; script-src ${hash(script)} 'wasm-unsafe-eval'; style-src ${hash(style)}; img-src data:; base-uri 'none'; form-action 'none'`;
const fill = { POLICY: policy, STYLE: style, LICENCE: escape(readFileSync(join(modules, "three", "LICENSE"), "utf8")), SCRIPT: script };
const MARK = "<!--leeway-data-->";
let page = readFileSync(join(here, "index.html"), "utf8").replace(/@([A-Z]+)@/g, (_, name) => fill[name]);
if (wasm) {
	const program = gzipSync(readFileSync(wasm), { level: 9 }).toString("base64");
	page = page.replace(MARK, () => `<script type="text/plain" id="program">${program}</script>\n${MARK}`);
}
if (page.split(MARK).length !== 2 || /[^\x00-\x7f]/.test(page)) {
	throw new Error("the page must hold its mark once, and plain characters only");
}
const pieces = page.match(/[^]{1,8000}/g).map((piece) => `R"LWPAGE(${piece})LWPAGE"`).join("\n");
writeFileSync(html, page);
writeFileSync(cpp, `// Written by planners/view/page/build.mjs\nextern const char* const leeway_page;\nconst char* const leeway_page =\n${pieces};\n`);
