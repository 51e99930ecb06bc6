// SPDX-License-Identifier: BSD-3-Clause
// Pages of leeway view in a headless Chromium: node view_test.mjs NAME. Each test is named for the fact that it holds.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync, statSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { Browser } from "./browser.mjs";
import { blindDistance, legibility } from "./legible.mjs";
import { DESK, GRID, SLIDE, deskPage, differing, file, leeway, random, read, table, turningPage, withPage, write } from "./support.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const text = (tab, id) => tab.value(`document.getElementById("${id}").textContent`);
const row = (tab, kind) => tab.value(`document.querySelector("#row-${kind} .value").textContent`);
/// The page's own form of a length.
const shown = (metres) => (Math.abs(metres) < 1 ? `${(1000 * metres).toFixed(2)} mm` : `${metres.toFixed(4)} m`);
/// As the reports have it: below a margin the attained value.
const stated = (lower, upper) => (Number(upper) <= 0 ? Number(upper) : Number(lower));

async function compareWithCheck(tab, model, states, answers) {
	const names = await tab.value("leeway.model.variables.map((v) => v.name)");
	const rows = table(answers);
	for (const [i, state] of states.entries()) {
		for (const [name, value] of Object.entries(state)) {
			const kept = await tab.value(`(${SLIDE})("joint-${names.indexOf(name)}", ${value})`);
			assert.equal(kept, value, "the slider keeps the value");
		}
		for (const [kind, lower, upper, first] of [["environment", "env_lower", "env_upper", "env_link"], ["self", "self_lower", "self_upper", "self_link1"]]) {
			const expected = rows[i][first] === "" ? "none in range" : shown(stated(rows[i][lower], rows[i][upper]));
			const found = await row(tab, kind), within_margin = Number(rows[i][upper]) <= 0 && Number(rows[i][lower]) < Number(rows[i][upper]);
			// Within a margin any pair may be found first: only the sign is the same
			assert.ok(within_margin ? /^at most -?[\d.]+ mm$/.test(found) && Number(found.match(/-?[\d.]+/)[0]) <= 0 : found === expected,
				`${kind} of state ${i}: ${found}, expected ${expected}: ${JSON.stringify(state)}`);
		}
	}
}

/// Random states within the limits of the sliders, as the page has them.
async function randomStates(tab, count) {
	const next = random();
	const sliders = await tab.value(`leeway.model.variables.map((v, i) => { const s = document.getElementById("joint-" + i); return v.group ? [v.name, Number(s.min), Number(s.max)] : null; }).filter((s) => s)`);
	return Array.from({ length: count }, () => Object.fromEntries(sliders.map(([name, low, high]) => [name, Number((low + next() * (high - low)).toFixed(6))])));
}

function csv(states) {
	return `${Object.keys(states[0]).join(",")}\n${states.map((state) => Object.values(state).join(",")).join("\n")}\n`;
}

async function liveAgainstCheck(page, model, count) {
	await withPage(page, {}, async (tab) => {
		assert.equal(tab.state, "live");
		const states = await randomStates(tab, count);
		write("states.csv", csv(states));
		const answers = leeway(["check", ...model, "--states", "states.csv"], [0, 1]).stdout;
		await compareWithCheck(tab, model, states, answers);
		// The same states in the same order, without those that the native program warms up with
		const names = await tab.value("leeway.model.group.map((i) => leeway.model.variables[i].name)"), WARM = 10, PASSES = 20;
		const q = states.map((state) => names.map((name) => state[name])).slice(WARM);
		const milliseconds = await tab.value(`(() => { const q = ${JSON.stringify(q)}, begin = performance.now(); for (let i = 0; i < ${PASSES}; ++i) { q.forEach((state) => leeway.engine.measure(state, 3, 0, false)); } return (performance.now() - begin) / ${PASSES} / q.length; })()`);
		const native = table(answers).map((r) => Number(r.microseconds)).slice(WARM).reduce((sum, x) => sum + x, 0) / q.length;
		console.log(`mean of ${q.length} states: ${(1000 * milliseconds).toFixed(1)} microseconds in the page, ${native.toFixed(1)} by leeway check`);
	});
}

const tests = {
	async APageLoadsWithoutErrorsAndAsksForNothing() {
		const page = deskPage();
		assert.ok(!/(src|href)="(?!data:)/.test(readFileSync(page, "utf8").replace(/<script type="module">[^]*<\/script>/, "")), "no address in the page");
		for (const width of [1280, 390]) {
			await withPage(page, { width, height: 844, touch: width < 600 }, async (tab) => {
				assert.equal(await text(tab, "title"), "desk_arm");
				assert.equal(await tab.value("document.documentElement.scrollWidth <= innerWidth"), true, `${width} pixels: nothing is cut off`);
				// The policy of the page stops a request that a script would make
				assert.equal(await tab.value(`fetch("https://example.org/").then(() => "sent", () => "refused")`), "refused");
				tab.errors = tab.errors.filter((error) => !error.includes("example.org"));
				tab.requests = tab.requests.filter((url) => !url.includes("example.org"));
			});
		}
	},

	async SlidersAndKeysMoveTheRobot() {
		await withPage(deskPage(), {}, async (tab) => {
			const look = async () => {
				await tab.picture();
				return tab.value(GRID);
			};
			let before = await look();
			const changes = async (what, act) => {
				await act();
				const after = await look();
				assert.ok(differing(before, after, 8) > 0, `${what} changes no pixel`);
				before = after;
			};
			await changes("a joint's slider", () => tab.value(`(${SLIDE})("joint-0", -1)`));
			await changes("the time slider", () => tab.value(`(${SLIDE})("time", 0.7)`));
			await tab.value(`document.getElementById("time").focus()`);
			await changes("M, the smallest clearance", () => tab.key("m"));
			assert.equal(await text(tab, "clearance"), await tab.value(`document.querySelector("#least .value").textContent`));
			const at = await tab.value("leeway.at");
			await tab.key(".");
			assert.ok(await tab.value("leeway.at") > at, "a full stop goes on by a step");
			await tab.value(`document.getElementById("canvas").focus()`);
			await changes("an arrow key", async () => { for (let i = 0; i < 4; ++i) { await tab.key("ArrowLeft"); } });
			await changes("minus", async () => { for (let i = 0; i < 4; ++i) { await tab.key("-"); } });
			await tab.key(" ");
			await tab.until(`leeway.at > 0.45 || leeway.playing === undefined`, "the motion plays");
			if (await tab.value(`leeway.playing !== undefined`)) { // else a slow machine has played all of it
				await tab.key(" ");
			}
			assert.equal(await text(tab, "play"), "Play");
			await tab.value(`document.querySelector("#joint-list input").focus()`);
			const value = await tab.value("leeway.q[0]");
			await tab.key("ArrowRight");
			assert.ok(await tab.value(`leeway.q[0] > ${value}`), "an arrow key moves a focussed slider");
			assert.ok(await tab.value(`[...document.querySelectorAll("button, input, select, summary")].every((e) => e.tabIndex >= 0)`), "all can be reached by Tab");
		});
	},

	async ANewSizeIsDrawnBeforeItIsShown() {
		await withPage(deskPage(), {}, async (tab) => {
			// Observers run in the order of their making, before the frame is shown: this one after that of the page
			const drawn = await tab.value(`new Promise((resolve) => {
				const stage = document.getElementById("stage");
				let before = null;
				new ResizeObserver(() => {
					if (before !== null) {
						resolve(leeway.stage.frames - before);
						return;
					}
					setTimeout(() => { before = leeway.stage.frames; stage.style.height = "300px"; }, 300);
				}).observe(stage);
			})`);
			assert.ok(drawn > 0, "a picture of a new size is empty for a frame");
		});
	},

	async AClickChoosesAPair() {
		await withPage(deskPage(), {}, async (tab) => {
			const { x, y } = await tab.middle("#row-self");
			await tab.click(x, y);
			assert.equal(await tab.value(`document.getElementById("row-self").getAttribute("aria-pressed")`), "true");
			const pair = await tab.value("leeway.answer.self");
			assert.deepEqual(await tab.value("leeway.stage.pair.from"), pair.from, "the line joins the chosen pair");
			assert.deepEqual(await tab.value("leeway.stage.links.map((l, i) => l.bodies.children.some((b) => b.material === leeway.stage.materials.chosen) ? i : -1).filter((i) => i >= 0)"), [pair.a, pair.b].sort((a, b) => a - b));
			// A click on the picture of the smallest clearance in the chart
			const minimum = await tab.middle("#chart .minimum");
			await tab.click(minimum.x, minimum.y);
			const least = await tab.value("leeway.steps[leeway.model.motion.least].at");
			assert.ok(Math.abs(await tab.value("leeway.at") - least) < 0.02, "the chart goes where it is clicked");
			await tab.value(`document.getElementById("pairs").open = true`);
			const first = await tab.middle("#pair-list button");
			await tab.click(first.x, first.y);
			assert.equal(await tab.value("leeway.at"), await tab.value("leeway.steps[leeway.model.motion.pairs[0].step].at"));
		});
	},

	async PairsThatKeepTheirDistanceAreNamedBesideTheSmallestClearance() {
		const page = turningPage();
		await withPage(page, {}, async (tab) => {
			assert.deepEqual(await tab.value("leeway.model.motion.apart.map((p) => [leeway.model.links[p.a], leeway.model.objects[p.b]])"), [["foot", "desk"], ["turret", "desk"]]);
			const least = await tab.value(`document.getElementById("least").textContent`);
			assert.match(least, /Smallest clearance, without 2 pairs that keep their distance \(foot – desk, turret – desk\)11\.27 mm/);
			assert.match(await text(tab, "apart"), /foot – desk10\.00 mmturret – desk136\.00 mm/);
			await tab.value(`document.getElementById("least").click()`);
			assert.equal(await text(tab, "clearance"), "11.27 mm", "the state's number is that of the other pairs");
			assert.match(await text(tab, "verdict-note"), /without 2 pairs that keep their distance/);
			// The chart shows the others: the whole line is not the constant 10 mm
			const heights = await tab.value(`new Set(document.querySelector("#chart .environment").getAttribute("points").split(" ").map((p) => p.split(",")[1])).size`);
			assert.ok(heights > 50, `the line has ${heights} heights`);
			// A pair that comes nearer than along the motion is shown again
			await tab.value(`leeway.model.motion.apart[0].least = 0.011; leeway.update(null)`);
			assert.equal(await text(tab, "clearance"), "10.00 mm");
		});
	},

	async SeveralPathsAreComparedInOnePage() {
		const path = (name, pitch) => write(name, `joint_names: [yaw, pitch]\npoints:\n  - positions: [-1.2, ${pitch}]\n  - positions: [1.2, ${pitch}]\n`);
		turningPage(); // writes the robot and its desk
		path("low.yaml", 0.4);
		path("high.yaml", -0.6);
		leeway(["view", "--robot", "turning.urdf", "--scene", "turning.yaml", "--path", "low.yaml", "--path", "high.yaml", "--out", "both.html"]);
		await withPage(file("both.html"), {}, async (tab) => {
			assert.deepEqual(await tab.value(`[...document.querySelectorAll("#which option")].map((o) => o.textContent)`), ["low.yaml", "high.yaml"]);
			const rows = await tab.value(`[...document.querySelectorAll("#compare tr")].slice(1).map((r) => [...r.cells].map((c) => c.textContent))`);
			assert.deepEqual(rows.map((r) => [r[0], r[1]]), [["low.yaml", "2.400"], ["high.yaml", "2.400"]]);
			assert.notEqual(rows[0][2], rows[1][2], "each has its own smallest clearance");
			assert.equal(await tab.value(`document.querySelectorAll("#chart .other").length`), 1, "the other one is pale in the chart");
			const least = () => tab.value(`document.querySelector("#least .value").textContent`);
			assert.equal(await least(), rows[0][2]);
			await tab.value(`(() => { const w = document.getElementById("which"); w.value = "1"; w.dispatchEvent(new Event("change")); })()`);
			assert.equal(await least(), rows[1][2]);
			assert.deepEqual(await tab.value("leeway.steps[0].q"), [-1.2, -0.6]);
			assert.deepEqual((await tab.value("leeway.groupState()")).map((v) => Number(v.toFixed(9))), [-1.2, -0.6], "the robot stands on the chosen path");
		});
		await withPage(turningPage(), {}, async (tab) => {
			assert.ok(await tab.value(`document.getElementById("which").hidden && document.getElementById("compare").hidden`), "one motion needs no choice");
		});
	},

	async EachPartOfATaskIsShownInItsOwnWorld() {
		const drive = (name, from, to) => write(name, `time,yaw,shoulder,elbow,wrist\n0,${from},0.9,0.9,0\n1,${to},0.9,0.9,0\n`);
		drive("there.csv", 0.9, 0.8);
		drive("back.csv", 0.8, 0.9);
		write("steps.yaml", "steps:\n- trajectory: there.csv\n- {attach: mug, link: hand}\n- allow: [mug, desk]\n- trajectory: back.csv\n- release: mug\n- trajectory: there.csv\n");
		leeway(["audit", ...DESK, "--steps", "steps.yaml", "--view", "steps.html"], [0, 1]);
		const browser = new Browser();
		try {
			const tab = await browser.open(file("steps.html"));
			const now = async () => {
				assert.equal(await tab.ready(), "live");
				return tab.value("({ objects: leeway.model.objects, links: leeway.model.links, at: leeway.steps[0].at, q: leeway.steps[0].q[0], chosen: Number(document.getElementById('chapter').value) })");
			};
			assert.deepEqual(await tab.ready().then(() => tab.value(`[...document.querySelectorAll("#chapter option")].map((o) => o.textContent)`)),
				["1. there.csv", "2. attach mug, allow contact of mug and desk, back.csv", "3. release mug, there.csv"]);
			const first = await now();
			assert.ok(first.objects.includes("mug") && !first.links.includes("mug"));
			await tab.value(`(() => { window.old = true; const w = document.getElementById("chapter"); w.value = "1"; w.dispatchEvent(new Event("change")); })()`);
			await tab.until("window.old === undefined && document.documentElement.dataset.ready !== undefined", "the next world is shown");
			const second = await now();
			assert.ok(!second.objects.includes("mug") && second.links.includes("mug"), `the mug is a link of the robot: ${second.links}`);
			assert.deepEqual([second.at, second.q, second.chosen], [1, 0.8, 1]);
			// At its end playing goes on in the next world
			await tab.value(`(() => { window.old = true; leeway.go(leeway.steps.at(-2).at); leeway.play(true); })()`);
			await tab.until("window.old === undefined && document.documentElement.dataset.ready !== undefined", "the last world is played");
			const third = await now();
			assert.ok(third.objects.includes("mug") && !third.links.includes("mug"));
			assert.deepEqual([third.at, third.chosen], [2, 2]);
			assert.deepEqual(tab.errors, [], "errors of the page");
		} finally {
			await browser.close();
		}
		await withPage(turningPage(), {}, async (tab) => {
			assert.ok(await tab.value(`document.getElementById("chapters").hidden`), "one world needs no choice");
		});
	},

	async SpeedAndSightsOfAGuardedDriveFollowItsTime() {
		write("drive.csv", "time,yaw,shoulder,elbow,wrist\n0,0.9,0.9,0.9,0\n1,0.5,0.9,0.9,0\n");
		const people = (x) => `{"collision_objects": [{"id": "anna", "primitives": [{"type": "sphere", "dimensions": [0.1]}], "primitive_poses": [{"position": [${x}, 0.3, 0.3], "orientation": [0, 0, 0, 1]}]}]}`;
		write("drive.jsonl", `{"t": 0}\n{"t": 0, "people": ${people(9)}}\n{"t": 0.3, "people": ${people(1)}}\n{"t": 0.7, "people": ${people(9)}}\n`);
		leeway(["guard", ...DESK, "--trajectory", "drive.csv", "--replay", "drive.jsonl", "--profile", "drive_profile.csv", "--view", "drive.html"], [0, 1]);
		const rows = table(read("drive_profile.csv"));
		await withPage(file("drive.html"), {}, async (tab) => {
			const at = await tab.value("leeway.steps.map((s) => s.at)");
			const [scale, proved, age] = await tab.value("leeway.model.curves.map((c) => c.values)");
			assert.ok(at.length > 20 && at[1] === 0.02, `${at.length} steps`);
			at.forEach((time, i) => {
				const row = rows.find((r) => Number(r.time) >= time - 1e-9);
				assert.ok(Math.abs(scale[i] - Number(row.scale)) < 1e-9 && Math.abs(proved[i] - (Number(row.proved_until) - Number(row.time))) < 1e-6, `at ${time}`);
			});
			assert.ok(Math.min(...scale) < 0.9 && Math.max(...scale) === 1, "the robot slows down beside somebody, and only there");
			assert.ok(age.at(-1) > age[0], "nobody looked again at the world");
			assert.deepEqual(await tab.value(`[...document.querySelectorAll("#curves polyline")].map((p) => p.getAttribute("points").split(" ").length)`), [at.length, at.length, at.length]);
			const names = await tab.value(`document.getElementById("curves").textContent`);
			assert.match(names, /speed scale.*proved for.*age of the sight/s);
			// the mark follows the time, and the state says what the guard answered
			await tab.value("leeway.go(0.501)");
			const places = await tab.value(`["chart", "curves"].map((id) => Number(document.querySelector("#" + id + " .now").getAttribute("x1")))`);
			assert.equal(places[0], places[1]);
			assert.match(await text(tab, "verdict-note"), /0\.50 s: .*proved until .* scale 0\./);
		});
		await withPage(turningPage(), {}, async (tab) => {
			assert.ok(await tab.value(`document.getElementById("curves").hasAttribute("hidden")`), "a path has clearances alone");
		});
	},

	async ArrowsShowTheNearPairsOfCheck() {
		write("near.csv", "yaw,shoulder,elbow,wrist\n0.2,0.43,0.8,0.1\n");
		const rows = table(leeway(["check", ...DESK, "--states", "near.csv", "--group", "arm", "--near", "0.2"]).stdout);
		assert.ok(rows.length > 5, `${rows.length} pairs`);
		const choose = (distance) => `(() => { const s = document.querySelector("select[aria-label='Way out of near pairs']"); s.value = "${distance}"; s.dispatchEvent(new Event("change")); })()`;
		await withPage(deskPage(), {}, async (tab) => {
			await tab.value(`leeway.q.splice(0, 4, 0.2, 0.43, 0.8, 0.1); leeway.update(null)`);
			const shown = () => tab.value("leeway.stage.arrows.heads.count");
			assert.equal(await shown(), 0, "none until they are asked for");
			await tab.value(choose(0.2));
			assert.equal(await shown(), rows.length);
			const pairs = await tab.value(`leeway.engine.near(leeway.groupState(), 3, 0.2).map((p) => [p.self ? "link" : "object", leeway.model.links[p.a], p.self ? leeway.model.links[p.b] : leeway.model.objects[p.b], p.upper, ...p.normal])`);
			rows.forEach((expected, i) => {
				assert.deepEqual(pairs[i].slice(0, 3), [expected.with, expected.link, expected.other]);
				[expected.upper, expected.normal_x, expected.normal_y, expected.normal_z].forEach((x, k) => assert.ok(Math.abs(pairs[i][3 + k] - x) < 1e-9, `pair ${i}`));
			});
			// The head of the first arrow is one shaft beyond the link's nearest point
			const [head, from] = await tab.value("[Array.from(leeway.stage.arrows.heads.instanceMatrix.array.slice(12, 15)), leeway.engine.near(leeway.groupState(), 3, 0.2)[0].from]");
			const normal = [rows[0].normal_x, rows[0].normal_y, rows[0].normal_z];
			head.forEach((x, k) => assert.ok(Math.abs(x - from[k] - 0.06 * normal[k]) < 1e-6, `${head}, ${from}`));
			await tab.value("leeway.q.splice(1, 2, -0.5, 0); leeway.update(null)");
			assert.notEqual(await shown(), rows.length, "arrows follow the state");
			await tab.value(choose(0));
			assert.equal(await shown(), 0);
		});
		await withPage(deskPage(["--stored"]), {}, async (tab) => {
			assert.equal(await tab.value(`document.querySelector("select[aria-label='Way out of near pairs']")`), null, "no choice without an engine");
		});
	},

	async TheNearestPartIsMarkedInTheChartAndAlongThePath() {
		await withPage(turningPage(), {}, async (tab) => {
			const part = await tab.value(`(() => { const r = document.querySelector("#chart .nearest"), x = (n) => Number(r.getAttribute(n)), c = leeway.chart;
				return leeway.steps.filter((s) => c.x(s.at) >= x("x") && c.x(s.at) <= x("x") + x("width")).map((s) => Math.min(...["environment", "self"].map((k) => s.others[k][0]))); })()`);
			const all = await tab.value(`leeway.steps.map((s) => Math.min(...["environment", "self"].map((k) => s.others[k][0])))`);
			const most = Math.min(...all) + 0.1 * (Math.max(...all) - Math.min(...all));
			assert.ok(part.length > 2 && part.length < all.length / 2 && part.includes(Math.min(...all)), `${part.length} steps of ${all.length}`);
			assert.ok(part.slice(2, -2).every((value) => value <= most), "no step of the marked part is far");
			// The arm's middle at both ends of the path, from its angles: 0.1 m along the turret's x axis, then 0.25 m along the arm
			const middle = (yaw, pitch) => [0.1 + 0.25 * Math.cos(pitch), 0.326 - 0.25 * Math.sin(pitch)].flatMap((v, i) => (i === 0 ? [v * Math.cos(yaw), v * Math.sin(yaw)] : [v]));
			const ends = await tab.value(`(() => { const p = leeway.stage.motion.trace.children[0].geometry.parameters.path.points; return [p[0], p.at(-1)].map((v) => v.toArray()); })()`);
			[middle(-1.2, 0.2), middle(1.2, 0.4)].forEach((expected, i) => expected.forEach((value, k) => assert.ok(Math.abs(value - ends[i][k]) < 1e-3, `end ${i} of the path: ${ends[i]}, expected ${expected}`)));
			const red = await tab.value(`leeway.stage.motion.trace.children.filter((m) => m.material === leeway.stage.materials.nearest).length`);
			assert.equal(red, 1, "a red part along the path");
			assert.equal(await tab.value(`leeway.stage.motion.ghosts.children.length`), 4, "turret and arm at start and goal; the foot stands still");
			// A drag in the chart moves the state along
			const at = (share) => tab.value(`(() => { const r = document.getElementById("chart").getBoundingClientRect(); return { x: r.x + 60 + ${share} * (r.width - 68), y: r.y + 60 }; })()`);
			const [from, to] = [await at(0.2), await at(0.8)];
			await tab.drag(from.x, from.y, to.x, to.y);
			assert.ok(Math.abs(await tab.value("leeway.at") - 0.8) < 0.02, "the state follows the pointer");
			await tab.picture();
			const with_ghosts = await tab.value(GRID);
			await tab.value(`[...document.querySelectorAll("#show label")].filter((l) => /Ghosts|Path/.test(l.textContent)).forEach((l) => l.querySelector("input").click())`);
			await tab.picture();
			assert.ok(differing(with_ghosts, await tab.value(GRID), 8) > 3, "both can be hidden");
		});
	},

	async LinksAndObjectsHaveTheColoursOfTheirFiles() {
		const link = (name, at, material) => `<link name="${name}"><visual><geometry><box size="1 1 1"/></geometry>${material}</visual><collision><origin xyz="${at}"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>`;
		const joint = (child) => `<joint name="to_${child}" type="revolute"><parent link="direct"/><child link="${child}"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>`;
		write("colours.urdf", `<robot name="colours"><material name="moss"><color rgba="0 0.5 0 1"/></material>${link("direct", "0 0 0.1", `<material name="x"><color rgba="1 0 0 0.5"/></material>`)}
			${link("named", "0 0 0.4", `<material name="moss"/>`)}${link("plain", "0 0 0.7", "")}${link("wrong", "0 0 1", `<material name="y"><color rgba="7 0 0 1"/></material>`)}${["named", "plain", "wrong"].map(joint).join("")}</robot>`);
		const object = (name, x) => `    - id: ${name}\n      primitives: [{type: box, dimensions: [0.1, 0.1, 0.1]}]\n      primitive_poses: [{position: [${x}, 0, 0.5], orientation: [0, 0, 0, 1]}]\n`;
		write("colours.yaml", `name: colours\nobject_colors: [{id: blue, color: {r: 0, g: 0, b: 1, a: 1}}]\nworld:\n  collision_objects:\n${object("blue", 1)}${object("grey", -1)}`);
		leeway(["view", "--robot", "colours.urdf", "--scene", "colours.yaml", "--out", "colours.html"]);
		await withPage(file("colours.html"), {}, async (tab) => {
			const look = () => tab.value(`Object.fromEntries([...leeway.stage.links.flatMap((l, i) => l.bodies.children.map((b) => [leeway.model.links[i], b.material])), ...leeway.stage.obstacles.children.map((b) => [leeway.model.objects[b.userData.object], b.material])]
				.map(([name, m]) => [name, m === leeway.stage.materials.robot ? "robot" : m === leeway.stage.materials.obstacle ? "obstacle" : m.color.getHexString() + " " + m.opacity]))`);
			assert.deepEqual(await look(), { direct: "ff0000 0.5", named: "008000 1", plain: "robot", wrong: "robot", blue: "0000ff 1", grey: "obstacle" });
			// A robot may be red by its file, as contact is
			await tab.value(`[...document.querySelectorAll("#show label")].find((l) => /Colours of the files/.test(l.textContent)).querySelector("input").click()`);
			assert.deepEqual(new Set(Object.values(await look())), new Set(["robot", "obstacle"]));
		});
	},

	async ATouchChoosesALink() {
		await withPage(deskPage(), { width: 390, height: 844, touch: true }, async (tab) => {
			const { x, y } = await tab.value(`(() => { const box = leeway.stage.links[0].bodies.children[0]; box.geometry.computeBoundingSphere();
				const p = box.geometry.boundingSphere.center.clone().applyMatrix4(box.matrixWorld).project(leeway.stage.camera), r = document.getElementById("canvas").getBoundingClientRect();
				return { x: r.x + (p.x + 1) / 2 * r.width, y: r.y + (1 - p.y) / 2 * r.height }; })()`);
			await tab.tap(x, y);
			await tab.until(`!document.getElementById("picked").hidden`, "a touched link is chosen");
			assert.match(await text(tab, "picked"), /^Chosen: (link|object) \w+/);
			const { x: px, y: py } = await tab.middle("#least");
			await tab.tap(px, py);
			await tab.until(`leeway.at === leeway.steps[leeway.model.motion.least].at`, "a touch goes to the smallest clearance");
		});
	},

	async LiveClearancesAreThoseOfCheck() {
		leeway(["view", ...DESK, "--group", "arm", "--out", "live.html"]); // without a motion no pair is set apart
		await liveAgainstCheck(file("live.html"), [...DESK, "--group", "arm"], 100);
		write("margins.yaml", "environment: 0.01\nlinks: {hand: 0.02}\nself: 0.005\n");
		const model = [...DESK, "--group", "arm", "--margins", file("margins.yaml"), "--allow", "turret:desk"];
		leeway(["view", ...model, "--out", "margins.html"]);
		await liveAgainstCheck(file("margins.html"), model, 30);
		await withPage(file("margins.html"), {}, async (tab) => {
			const [margin, ball] = await tab.value("[leeway.stage.pair.margin, leeway.stage.ball.visible ? leeway.stage.ball.scale.x : 0]");
			assert.ok(margin > 0 && ball === margin, `the ball shows the margin: ${ball}, ${margin}`);
			assert.match(await text(tab, "now"), /less the margin of \d+\.\d\d mm/);
		});
	},

	async StoredClearancesAreThoseOfCheck() {
		write("states.csv", "yaw,shoulder,elbow,wrist\n0,0.4,0.3,0\n0.5,0.2,0.9,-0.4\n-0.7,0.9,0.2,0.8\n");
		const model = [...DESK, "--group", "arm"];
		leeway(["view", ...model, "--states", "states.csv", "--stored", "--out", "stored.html"]);
		const rows = table(leeway(["check", ...model, "--states", "states.csv"], [0, 1]).stdout);
		await withPage(file("stored.html"), {}, async (tab) => {
			assert.equal(tab.state, "stored");
			for (const i of [0, 2, 1]) {
				await tab.value(`(${SLIDE})("time", ${i})`);
				assert.equal(await row(tab, "environment"), shown(stated(rows[i].env_lower, rows[i].env_upper)));
				assert.equal(await row(tab, "self"), shown(stated(rows[i].self_lower, rows[i].self_upper)));
			}
			await tab.value(`(${SLIDE})("joint-0", 0.123)`);
			assert.equal(await text(tab, "clearance"), "–", "a state moved by hand has no stored clearance");
			assert.equal(await text(tab, "verdict"), "not measured");
		});
	},

	async HostileNamesStayText() {
		const names = ["</script><script>window.hacked=1</script>", "<img src=x onerror=window.hacked=2>", "<!--<script>", "'\"><svg onload=window.hacked=3>", "a&lt;b\u2028c", "</script x", "<!--<script x"];
		const xml = (name) => name.replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);
		const mesh = "m&lt;<b>'.obj";
		write(mesh, "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n");
		const collision = (i) => `<collision><origin xyz="0 0 ${0.3 * i}"/><geometry>${i === 0 ? `<mesh filename="${xml(file(mesh))}"/>` : `<box size="0.1 0.1 0.1"/>`}</geometry></collision>`;
		const links = names.map((name, i) => `<link name="${xml(name)}">${collision(i)}</link>`).join("");
		const joints = names.slice(1).map((name, i) => `<joint name="${xml(`j${name}`)}" type="revolute"><parent link="${xml(names[i])}"/><child link="${xml(name)}"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>`).join("");
		write("<b>hostile.urdf", `<robot name="${xml(names[0])}">${links}${joints}</robot>`);
		write("scene.yaml", `name: ${JSON.stringify(names[1])}\nworld:\n  collision_objects:\n${names.map((name, i) => `    - id: ${JSON.stringify(`o${name}`)}\n      primitives: [{type: box, dimensions: [0.1, 0.1, 0.1]}]\n      primitive_poses: [{position: [1, ${i}, 0.2], orientation: [0, 0, 0, 1]}]\n`).join("")}`);
		leeway(["view", "--robot", "<b>hostile.urdf", "--scene", "scene.yaml", "--out", "hostile.html"]);
		await withPage(file("hostile.html"), {}, async (tab) => {
			assert.equal(await tab.value("typeof window.hacked"), "undefined");
			assert.equal(await tab.value(`document.querySelectorAll("img, script[src], b, #panel svg:not(#chart, #curves)").length`), 0, "no element of a name");
			assert.equal(await text(tab, "title"), names[0]);
			assert.deepEqual(await tab.value("leeway.model.links"), names);
			assert.deepEqual(await tab.value("leeway.model.objects"), names.map((name) => `o${name}`));
			assert.ok((await text(tab, "joint-list")).includes(`j${names[1]}`));
			assert.ok((await text(tab, "notes")).includes("<b>hostile.urdf"));
			// Injected by hand, a script does not run either
			await tab.value(`document.body.append(Object.assign(document.createElement("script"), { textContent: "window.hacked = 4" }))`);
			assert.equal(await tab.value("typeof window.hacked"), "undefined", "the policy refuses scripts that are not the page's own");
			tab.errors = tab.errors.filter((error) => !/Content Security Policy/.test(error));
		});
	},

	async ContactIsRedAndNamed() {
		write("states.csv", "yaw,shoulder,elbow,wrist\n0,0.4,0.3,0\n");
		leeway(["view", ...DESK, "--group", "arm", "--out", "contact.html"]);
		leeway(["view", ...DESK, "--group", "arm", "--out", "stored.html", "--stored", "--states", join(process.env.LEEWAY_EXAMPLE, "states.csv")]);
		const rows = table(leeway(["check", ...DESK, "--group", "arm", "--states", join(process.env.LEEWAY_EXAMPLE, "states.csv")], [1]).stdout);
		const red = (tab) => tab.value(`[...leeway.stage.links.flatMap((l, i) => l.bodies.children.map((b) => [b, leeway.model.links[i]])), ...leeway.stage.obstacles.children.map((b) => [b, leeway.model.objects[b.userData.object]])]
			.filter(([b]) => b.material === leeway.stage.materials.touching).map(([, name]) => name)`);
		await withPage(file("stored.html"), {}, async (tab) => {
			for (const [i, { env_upper, env_link, env_object, self_upper, self_link1, self_link2 }] of rows.entries()) {
				await tab.value(`(${SLIDE})("time", ${i})`);
				const names = new Set(await red(tab)), contact = [[env_upper, env_link, env_object], [self_upper, self_link1, self_link2]].filter(([upper]) => Number(upper) <= 0);
				for (const [, a, b] of contact) {
					assert.ok(names.has(a) && names.has(b), `${a} and ${b} are red in state ${i}: ${[...names]}`);
				}
				assert.equal(names.size > 0, contact.length > 0, `state ${i}: ${[...names]}`);
				assert.equal(await text(tab, "verdict"), contact.length > 0 ? "▲ in contact" : "● free");
			}
		});
		await withPage(file("contact.html"), {}, async (tab) => {
			const state = table(readFileSync(join(process.env.LEEWAY_EXAMPLE, "states.csv"), "utf8"))[3], names = await tab.value("leeway.model.variables.map((v) => v.name)");
			for (const [name, value] of Object.entries(state)) {
				await tab.value(`(${SLIDE})("joint-${names.indexOf(name)}", ${value})`);
			}
			assert.ok((await red(tab)).includes("lamp"), "found by the engine in the page");
		});
	},

	async JointsOfEveryTypeMoveAsInTheEngine() {
		const joint = (name, type, parent, child, inside) => `<joint name="${name}" type="${type}"><parent link="${parent}"/><child link="${child}"/><origin xyz="0.3 0.1 0.2" rpy="0.4 -0.3 0.9"/>${inside}</joint>`;
		const chain = [["turn", "revolute", `<axis xyz="1 2 -0.5"/><limit lower="-2" upper="2" effort="1" velocity="1"/>`], ["wheel", "continuous", `<axis xyz="0 1 0"/>`],
			["slide", "prismatic", `<axis xyz="0 3 4"/><limit lower="-0.5" upper="0.5" effort="1" velocity="1"/>`], ["plate", "planar", `<axis xyz="1 1 1"/>`], ["float", "floating", ""],
			["follow", "revolute", `<axis xyz="0 0 -1"/><mimic joint="turn" multiplier="-1.5" offset="0.2"/><limit lower="-4" upper="4" effort="1" velocity="1"/>`]];
		const ball = `<collision><origin xyz="0.05 0.02 -0.04"/><geometry><sphere radius="0.01"/></geometry></collision>`;
		const links = Array.from({ length: chain.length + 1 }, (_, i) => `<link name="l${i}">${ball}</link>`).join("");
		write("all.urdf", `<robot name="all">${links}${chain.map(([name, type, inside], i) => joint(name, type, `l${i}`, `l${i + 1}`, inside)).join("")}</robot>`);
		leeway(["view", "--robot", "all.urdf", "--out", "all.html"]);
		await withPage(file("all.html"), {}, async (tab) => {
			const seen = new Set(), next = random();
			for (let i = 0; i < 300; ++i) {
				const q = await tab.value("leeway.q.length");
				const state = Array.from({ length: q }, () => Number((2 * next() - 1).toFixed(4)));
				const worst = await tab.value(`(() => { leeway.q = ${JSON.stringify(state)}; leeway.update(null); const c = leeway.answer.self, m = (i) => leeway.stage.links[i].frame.matrix.elements;
					const off = (i, p) => { const e = m(i), b = [0.05, 0.02, -0.04]; return Math.hypot(...[0, 1, 2].map((k) => e[k] * b[0] + e[4 + k] * b[1] + e[8 + k] * b[2] + e[12 + k] - p[k])); };
					return [c.a, c.b, off(c.a, c.from), off(c.b, c.to), c.upper]; })()`);
				const radius = worst[4] > 0 ? [worst[2], worst[3]] : [0.01, 0.01];
				radius.forEach((r) => assert.ok(Math.abs(r - 0.01) < 1e-9, `links ${worst[0]}, ${worst[1]} of state ${JSON.stringify(state)}: ${worst}`));
				seen.add(worst[0]).add(worst[1]);
			}
			assert.equal(seen.size, chain.length + 1, `each link was compared: ${[...seen]}`);
		});
	},

	async TextIsLegible() {
		await withPage(deskPage(), {}, async (tab) => {
			await tab.value(`document.querySelectorAll("details").forEach((d) => { d.open = true; })`);
			for (const theme of ["light", "dark"]) {
				await tab.value(`leeway.theme("${theme}")`);
				const poor = (await tab.value(legibility)).filter(({ ratio, needed }) => ratio < needed);
				assert.deepEqual(poor, [], `${theme}: contrast of text`);
				const colours = await tab.value(`Object.fromEntries(["--danger", "--robot", "--obstacle", "--accent"].map((n) => [n, getComputedStyle(document.documentElement).getPropertyValue(n).trim()]))`);
				for (const plain of ["--robot", "--obstacle"]) {
					const distance = blindDistance(colours["--danger"], colours[plain]);
					assert.ok(distance > 15, `${theme}: contact and ${plain.slice(2)} differ by ${distance.toFixed(1)} only for the colour-blind`);
				}
			}
		});
	},

	async ThePictureIsTheExpectedOne() {
		const expected = join(here, "expected.json");
		await withPage(deskPage(), { hash: "#at=least&theme=light&camera=-60,25,2" }, async (tab) => {
			await tab.picture();
			const grid = await tab.value(GRID);
			if (process.env.LEEWAY_WRITE_EXPECTED) {
				writeFileSync(expected, `${JSON.stringify(grid).replaceAll("]],", "]],\n")}\n`);
			}
			const stored = JSON.parse(readFileSync(expected, "utf8")), count = differing(grid, stored);
			assert.ok(count <= 6, `${count} of ${grid.flat().length} cells differ from tests/view/expected.json`);
			await tab.value(`(${SLIDE})("joint-0", -2)`);
			await tab.picture();
			assert.ok(differing(await tab.value(GRID), stored) > 6, "another state looks otherwise");
		});
	},

	async WithoutGraphicsAPageSaysSo() {
		const page = deskPage(), browser = new Browser(["--disable-3d-apis"]);
		try {
			const tab = await browser.open(page);
			assert.equal(await tab.ready(), "failed");
			assert.equal(await text(tab, "problem"), "This browser shows no 3D pictures: its WebGL is off.");
			assert.equal(await tab.value(`document.getElementById("problem").checkVisibility()`), true);
		} finally {
			await browser.close();
		}
	},

	async PngNeedsNoPage() {
		leeway(["view", ...DESK, "--png", "out.png", "--camera", "-60,25,2", "--width", "640", "--height", "400"]);
		const png = readFileSync(file("out.png"));
		assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [640, 400]);
		assert.ok(png.length > 8000, `${png.length} bytes: an empty picture`);
		const none = leeway(["view", ...DESK, "--png", "none.png"], [2], { LEEWAY_BROWSER: "", PATH: "/nowhere" });
		assert.match(none.stderr, /--png: no Chromium was found.*; install one/);
		assert.throws(() => statSync(file("none.png")));
	},

	async ArmarAnswersAsCheckDoes() {
		const data = process.env.LEEWAY_DATA_DIR, model = ["--robot", join(data, "armar3/armar3.urdf"), "--srdf", join(data, "armar3/armar3.srdf"), "--scene", join(data, "kit_kitchen/scene.yaml")];
		leeway(["view", ...model, "--out", "armar.html"]);
		await liveAgainstCheck(file("armar.html"), model, 40);
	},

	async TheKitchenIsSmallerThan15Megabytes() {
		assert.equal(spawnSync(process.env.LEEWAY_KITCHEN, [file("demo")]).status, 0);
		const model = ["--robot", "demo/robot.urdf", "--srdf", "demo/robot.srdf", "--scene", "demo/scene.yaml"];
		leeway(["plan", ...model, "--request", "demo/reach/04_table.yaml", "--out", "path.yaml"]);
		leeway(["view", ...model, "--path", "path.yaml", "--out", "kitchen.html"]);
		const megabytes = statSync(file("kitchen.html")).size / 1e6;
		assert.ok(megabytes < 15, `${megabytes} MB`);
		await withPage(file("kitchen.html"), {}, async (tab) => {
			assert.equal(tab.state, "live");
			const stepped = await tab.value("leeway.steps[5]"), at = stepped.at;
			await tab.value(`(${SLIDE})("time", ${at})`);
			const environment = (stepped.others ?? stepped).environment;
			assert.equal(await row(tab, "environment"), shown(stated(environment[0], environment[1])));
			const frames = await tab.value(`new Promise((done) => { const begin = performance.now(), first = leeway.stage.frames; leeway.play(true); setTimeout(() => { leeway.play(false); done(1000 * (leeway.stage.frames - first) / (performance.now() - begin)); }, 3000); })`);
			console.log(`${megabytes.toFixed(1)} MB; first picture after ${await tab.value("document.documentElement.dataset.picture")} ms; ${frames.toFixed(1)} frames per second in software`);
			assert.ok(read("kitchen.html").includes("triangles are shown"), "the page says what it simplifies");
		});
	},
};

const name = process.argv[2];
if (tests[name] === undefined) {
	console.log(`no test ${name}; there are ${Object.keys(tests).join(", ")}`);
	process.exit(2);
}
await tests[name]();
console.log(`${name}: passed`);
