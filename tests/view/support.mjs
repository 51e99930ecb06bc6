// SPDX-License-Identifier: BSD-3-Clause
// Files, runs of the program, and pages in a browser, for the tests of pages.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Browser } from "./browser.mjs";

export const folder = mkdtempSync(join(tmpdir(), "leeway-view-test-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

export const file = (name) => join(folder, name);
export const read = (name) => readFileSync(file(name), "utf8");

export function write(name, text) {
	writeFileSync(file(name), text);
	return file(name);
}

/// Runs the program; it must end with one of these statuses.
export function leeway(args, statuses = [0], environment = {}) {
	const run = spawnSync(process.env.LEEWAY_PROGRAM, args, { cwd: folder, encoding: "utf8", env: { ...process.env, ...environment } });
	assert.ok(statuses.includes(run.status), `leeway ${args.join(" ")}: status ${run.status}: ${run.stderr}`);
	return run;
}

const example = (name) => join(process.env.LEEWAY_EXAMPLE, name);
export const DESK = ["--robot", example("arm.urdf"), "--srdf", example("arm.srdf"), "--scene", example("scene.yaml")];
/// A way over the lamp: its smallest clearance, 8.8 mm, is where the hand comes to the lamp.
const PATH = `group: arm
joint_names: [yaw, shoulder, elbow, wrist]
points:
  - positions: [0.9, 0.9, 0.9, 0]
  - positions: [0.2228, 0.4319, 0.8023, 0.1104]
  - positions: [-0.2272, 0.4319, 0.8023, 0.1104]
  - positions: [-0.9, 0.9, 0.9, 0]
`;

/// A page of the desk with a path.
export function deskPage(more = []) {
	write("path.yaml", PATH);
	leeway(["view", ...DESK, "--path", "path.yaml", "--out", "page.html", ...more]);
	return file("page.html");
}

/// A page of a column that turns 136 mm above a desk, on a foot 10 mm above it; its arm passes 11.27 mm over a post.
export function turningPage() {
	const box = (name, size, at) => `    - id: ${name}\n      primitives: [{type: box, dimensions: [${size}]}]\n      primitive_poses: [{position: [${at}], orientation: [0, 0, 0, 1]}]\n`;
	const link = (name, at, shape) => `<link name="${name}"><collision><origin xyz="${at}"/><geometry>${shape}</geometry></collision></link>`;
	const joint = (name, parent, child, at, axis) => `<joint name="${name}" type="revolute"><parent link="${parent}"/><child link="${child}"/><origin xyz="${at}"/><axis xyz="${axis}"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>`;
	write("turning.urdf", `<robot name="turning">${link("foot", "0 0 0.05", `<cylinder radius="0.08" length="0.1"/>`)}${link("turret", "0 0 0.05", `<cylinder radius="0.06" length="0.1"/>`)}
		${link("arm", "0.25 0 0", `<box size="0.4 0.05 0.05"/>`)}${joint("yaw", "foot", "turret", "0 0 0.126", "0 0 1")}${joint("pitch", "turret", "arm", "0.1 0 0.2", "0 1 0")}</robot>`);
	write("turning.yaml", `name: desk\nworld:\n  collision_objects:\n${box("desk", "2, 2, 0.1", "0, 0, -0.06")}${box("post", "0.1, 0.1, 0.3", "0.5, 0, 0.15")}`);
	write("turning_path.yaml", "joint_names: [yaw, pitch]\npoints:\n  - positions: [-1.2, 0.2]\n  - positions: [0, -0.1]\n  - positions: [1.2, 0.4]\n");
	leeway(["view", "--robot", "turning.urdf", "--scene", "turning.yaml", "--path", "turning_path.yaml", "--out", "turning.html"]);
	return file("turning.html");
}

/// Opens a page, runs the check, and closes all. The page must have no errors and must ask for nothing but itself.
export async function withPage(page, options, check) {
	const browser = new Browser();
	try {
		const tab = await browser.open(page, options);
		tab.state = await tab.ready();
		await check(tab);
		assert.deepEqual(tab.errors, [], "errors of the page");
		assert.deepEqual(tab.requests.filter((url) => !url.startsWith("file://") && !url.startsWith("data:")), [], "requests of the page");
		assert.equal(tab.requests.filter((url) => url.startsWith("file://")).length, 1, `files that were asked for: ${tab.requests.filter((url) => url.startsWith("file://"))}`);
	} finally {
		await browser.close();
	}
}

/// Numbers in [0, 1) from a seed that is printed; $LEEWAY_TEST_SEED sets another.
export function random() {
	let state = Number(process.env.LEEWAY_TEST_SEED ?? 20061) >>> 0;
	console.log(`seed ${state}`);
	return () => { // Mulberry32
		state = (state + 0x6d2b79f5) >>> 0;
		let t = Math.imul(state ^ (state >>> 15), 1 | state);
		t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
		return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
	};
}

/// The rows of a table as objects.
export function table(text) {
	const [header, ...rows] = text.trim().split("\n").filter((line) => !line.startsWith("#")).map((line) => line.split(",").map((cell) => cell.trim()));
	return rows.map((row) => Object.fromEntries(header.map((name, i) => [name, row[i]])));
}

/// Mean colours of the canvas in a coarse grid, [rows][columns][3].
export const GRID = `(() => {
	leeway.stage.draw(); // the picture is there until the end of this task
	const small = document.createElement("canvas"), columns = 24, rows = 16;
	[small.width, small.height] = [columns, rows];
	const context = small.getContext("2d");
	context.imageSmoothingQuality = "high";
	context.drawImage(document.getElementById("canvas"), 0, 0, columns, rows);
	const data = context.getImageData(0, 0, columns, rows).data;
	return Array.from({ length: rows }, (_, y) => Array.from({ length: columns }, (_, x) => Array.from(data.slice(4 * (y * columns + x), 4 * (y * columns + x) + 3))));
})()`;

/// Number of cells of two grids whose colours differ by more than `most` of 255.
export function differing(a, b, most = 24) {
	return a.flat().filter((cell, i) => cell.some((value, k) => Math.abs(value - b.flat()[i][k]) > most)).length;
}

/// Moves a slider as a hand would.
export const SLIDE = `(id, value) => { const s = document.getElementById(id); s.value = value; s.dispatchEvent(new Event("input", { bubbles: true })); return Number(s.value); }`;
