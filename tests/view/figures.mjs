// SPDX-License-Identifier: BSD-3-Clause
// Figures of pages in a headless Chromium that draws by software: node figures.mjs PAGE.html... prints a table. With --pictures FOLDER
// it also writes screenshots of 1,280 and of 390 pixels.
import { statSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { Browser } from "./browser.mjs";

const SECONDS = 3; // of each measurement

/// Frames per second while the motion plays, or while a joint's slider moves to and fro.
const FRAMES = `new Promise((done) => {
	const page = window.leeway, begin = performance.now(), first = page.stage.frames;
	const variable = page.model.group[0], slider = document.getElementById("joint-" + variable), low = Number(slider.min), high = Number(slider.max);
	const next = (now) => {
		const t = (now - begin) / 1000;
		if (t > ${SECONDS}) { done((page.stage.frames - first) / t); return; }
		if (page.steps.length < 2) { slider.value = low + (high - low) * (0.5 + 0.5 * Math.sin(t)); slider.dispatchEvent(new Event("input")); }
		requestAnimationFrame(next);
	};
	if (page.steps.length > 1) { page.play(true); }
	requestAnimationFrame(next);
})`;

/// Microseconds of the engine for random states within the limits.
const STATES = `(() => {
	const page = window.leeway;
	if (page.engine === null) { return NaN; }
	const q = () => page.model.group.map((i) => { const s = document.getElementById("joint-" + i); return Number(s.min) + Math.random() * (s.max - s.min); });
	const states = Array.from({ length: 300 }, q), begin = performance.now();
	states.forEach((state) => page.engine.measure(state, page.model.what, page.model.min_d, false));
	return 1000 * (performance.now() - begin) / states.length;
})()`;

const pages = process.argv.slice(2), at = pages.indexOf("--pictures"), folder = at < 0 ? null : pages.splice(at, 2)[1];
console.log("| page | MB | triangles drawn | first picture, ms | engine ready, ms | frames per second | microseconds per state |\n|---|---|---|---|---|---|---|");
for (const page of pages) {
	const browser = new Browser();
	const tab = await browser.open(page, { hash: "#theme=light&at=least" });
	const state = await tab.ready(), ready = performance.now() - tab.begun;
	if (folder !== null) {
		writeFileSync(join(folder, `${basename(page, ".html")}_1280.png`), await tab.picture());
	}
	const triangles = await tab.value("leeway.stage.renderer.info.render.triangles"), picture = await tab.value("document.documentElement.dataset.picture");
	const states = await tab.value(STATES), frames = await tab.value(FRAMES);
	console.log(`| ${basename(page)} | ${(statSync(page).size / 1e6).toFixed(1)} | ${triangles} | ${picture} | ${state === "live" ? ready.toFixed(0) : "none"} | ${frames.toFixed(0)} | ${states.toFixed(0)} |`);
	if (folder !== null) {
		const narrow = await browser.open(page, { width: 390, height: 844, touch: true, hash: "#theme=light&at=least" });
		await narrow.ready();
		writeFileSync(join(folder, `${basename(page, ".html")}_390.png`), await narrow.picture());
	}
	await browser.close();
}
