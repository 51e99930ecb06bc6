// SPDX-License-Identifier: BSD-3-Clause
// The page: state, motion, engine and their events.
import { Chart } from "./chart.js";
import { Curves } from "./curves.js";
import { block, chapter, model as readModel } from "./data.js";
import { Engine } from "./engine.js";
import { between } from "./kinematics.js";
import { makeChoices, makeJoints, makeNotes, pairNames, showAnswer } from "./panel.js";
import { Stage } from "./stage.js";
import { makeTrace } from "./trace.js";
import { asideOf, describeApart, showApart } from "./apart.js";
import { clearanceOf, element, length, place, stated, statement } from "./text.js";

const $ = (id) => document.getElementById(id), SECONDS_OF_PLAY = 8; // of a motion without times
const UNKNOWN = { environment: null, self: null, touching: [] };

/// The smaller clearance of a step, of the pairs that are not set apart.
function leastOf(step) {
	return ["environment", "self"].map((kind) => clearanceOf((step.others ?? step)[kind])).filter((c) => c !== null).sort((a, b) => stated(a) - stated(b))[0];
}

class Page {
	constructor(model, bytes) {
		this.model = model;
		this.motions = [model.motion, ...(model.more ?? [])];
		this.steps = model.motion.steps;
		this.q = this.full(this.steps[0].q);
		this.engine = null;
		this.at = this.steps[0].at;
		this.chosen = null; // kind of a pair that the user chose; null: the nearer one
		this.picked = null;
		this.near = 0; // metres: pairs below it show their way out
		this.stage = new Stage($("canvas"), model, bytes);
	}

	full(q) {
		const full = this.model.reference.slice();
		this.model.group.forEach((variable, i) => { full[variable] = q[i]; });
		return full;
	}

	groupState() {
		return this.model.group.map((variable) => this.q[variable]);
	}

	/// @param step of the motion at which the state is, with its stored answer; null: none
	/// @param label said of the state
	update(step, label = step?.label ?? "") {
		let answer = UNKNOWN, note = "";
		if (this.engine !== null) {
			answer = this.engine.measure(this.groupState(), this.model.what, this.model.min_d);
		} else if (step !== null) {
			const both = (from) => ({ environment: clearanceOf(from.environment), self: clearanceOf(from.self) });
			answer = { ...both(step), others: both(step.others ?? step), touching: step.touching ?? [] };
		} else {
			note = "a state moved by hand";
		}
		const { aside, ...kept } = asideOf(this.model, answer);
		this.answer = { ...kept, touching: step?.marked ?? answer.touching }; // a list of contacts marks one pair at a time
		this.aside = aside;
		this.stage.pose(this.q);
		showAnswer(this.model, this.answer, [label !== "" ? label : note, describeApart(this.model, aside)].filter((t) => t !== "").join("; "));
		this.showPair();
		this.showNear();
	}

	/// The way out of all pairs that are nearer than the chosen distance.
	showNear() {
		if (this.near > 0 && this.engine !== null) {
			this.stage.showNear(this.engine.near(this.groupState(), this.model.what, this.near), this.near);
		} else if (this.near === 0) {
			this.stage.showNear([], 1);
		}
	}

	/// The kind of the pair whose witness is shown.
	kind() {
		const upper = (kind) => this.answer[kind]?.upper ?? Infinity;
		return this.chosen ?? (upper("self") < upper("environment") ? "self" : "environment");
	}

	showPair() {
		const kind = this.kind(), pair = this.answer[kind], known = pair !== null && pair.upper !== null;
		this.stage.showWitness(known ? pair : null);
		this.tag = known ? length(Math.max(0, pair.upper + pair.margin)) : "";
		const chosen = { links: [], objects: [] };
		if (this.chosen !== null && known) {
			chosen.links.push(pair.a);
			(kind === "self" ? chosen.links : chosen.objects).push(pair.b);
		}
		if (this.picked?.link !== undefined) {
			chosen.links.push(this.picked.link);
		}
		if (this.picked?.object !== undefined) {
			chosen.objects.push(this.picked.object);
		}
		for (const name of ["environment", "self"]) {
			$(`row-${name}`).setAttribute("aria-pressed", String(this.chosen === name));
		}
		this.stage.paint(this.answer.touching, chosen);
	}

	choose(kind) {
		this.chosen = this.chosen === kind ? null : kind;
		this.showPair();
	}

	pick(owner) {
		this.picked = owner;
		this.stage.onlyHull(owner?.link);
		$("picked").hidden = owner === null;
		$("picked").textContent = owner === null ? "" : owner.link !== undefined ? `Chosen: link ${this.model.links[owner.link]}` : `Chosen: object ${this.model.objects[owner.object]}`;
		this.showPair();
	}

	// ---- motion

	nearestStep(at) {
		return this.steps.reduce((best, step, i) => (Math.abs(step.at - at) < Math.abs(this.steps[best].at - at) ? i : best), 0);
	}

	/// Goes to a place of the motion. Without an engine, and in a list of states, to the nearest measured state.
	go(at) {
		const nearest = this.nearestStep(at), exact = this.steps[nearest].at === at;
		if (this.engine === null || exact || this.model.motion.unit === "state") {
			this.at = this.steps[nearest].at;
			this.q = this.full(this.steps[nearest].q);
			this.update(this.steps[nearest]);
		} else {
			const next = Math.max(1, this.steps.findIndex((step) => step.at > at)), a = this.steps[next - 1], b = this.steps[next];
			this.at = at;
			this.q = this.full(between(this.model, a.q, b.q, (at - a.at) / (b.at - a.at || 1)));
			this.update(null, this.steps[nearest].label);
		}
		$("time").value = this.at;
		$("time-text").textContent = place(this.at, this.model.motion.unit);
		this.chart?.mark(this.at);
		this.curves?.mark(this.at);
		this.joints?.forEach((show, i) => show?.(this.q[i]));
	}

	step(by) {
		const index = this.nearestStep(this.at) + by;
		this.go(this.steps[Math.min(this.steps.length - 1, Math.max(0, index))].at);
	}

	play(on = this.playing === undefined) {
		$("play").textContent = on ? "Pause" : "Play";
		if (!on) {
			cancelAnimationFrame(this.playing);
			this.playing = undefined;
			return;
		}
		const first = this.steps[0].at, last = this.steps.at(-1).at, seconds = this.model.motion.unit === "seconds" ? last - first : SECONDS_OF_PLAY;
		let at = this.at >= last ? first : this.at, before = performance.now();
		const next = (now) => {
			at += (now - before) / 1000 * (last - first) / seconds;
			before = now;
			this.go(Math.min(at, last));
			if (at >= last) {
				this.play(false);
				if (chapter + 1 < this.model.chapters.length) {
					this.openChapter(chapter + 1, true);
				}
			} else {
				this.playing = requestAnimationFrame(next);
			}
		};
		this.playing = requestAnimationFrame(next);
	}

	makeMotion() {
		if (this.steps.length < 2) {
			return;
		}
		$("motion").hidden = false;
		$("time").addEventListener("input", () => this.go(Number($("time").value)));
		$("play").addEventListener("click", () => this.play());
		$("least").addEventListener("click", () => this.go(this.steps[this.model.motion.least].at));
		this.chart = new Chart($("chart"), this.model, (at) => this.go(at));
		this.curves = new Curves($("curves"), this.model, this.chart);
		this.makeChoice();
		this.showMotion();
	}

	/// What is said of the chosen motion.
	showMotion() {
		const { motion } = this.model, least = this.steps[motion.least];
		$("motion-title").textContent = motion.unit === "state" ? `${this.steps.length} states` : motion.unit === "seconds" ? "Trajectory" : "Path";
		Object.assign($("time"), { min: this.steps[0].at, max: this.steps.at(-1).at, step: motion.unit === "state" ? 1 : "any" });
		const nearest = leastOf(least);
		$("least").replaceChildren(element("span", ["Smallest clearance", describeApart(this.model, motion.apart)].filter((t) => t !== "").join(", "), { class: "pair" }), element("span", nearest === undefined ? "–" : statement(nearest), { class: "value" }),
			element("span", `at ${place(least.at, motion.unit)}`, { class: "kind" }));
		showApart(this.model, $("apart"));
		$("pair-list").replaceChildren();
		for (const pair of motion.pairs) {
			const kind = pair.self ? "self" : "environment", row = element("button", "", { type: "button", class: "row" });
			row.append(element("span", pairNames(this.model, kind, pair.a, pair.b), { class: "pair" }), element("span", length(pair.upper), { class: "value" }),
				element("span", `at ${place(this.steps[pair.step].at, motion.unit)}`, { class: "kind" }));
			row.addEventListener("click", () => {
				this.chosen = kind;
				this.go(this.steps[pair.step].at);
			});
			$("pair-list").append(row);
		}
		this.chart.show(motion, this.motions.filter((other) => other !== motion));
		this.chart.draw();
		this.curves.draw();
	}

	/// Several motions: a choice, and a row for each.
	makeChoice() {
		if (this.motions.length < 2) {
			return;
		}
		$("which").hidden = $("compare").hidden = false;
		const head = element("tr");
		head.append(...["Motion", "length", "least"].map((name) => element("th", name)));
		$("compare").append(head);
		this.motions.forEach((motion, i) => {
			const name = motion.source.split("/").at(-1), nearest = leastOf(motion.steps[motion.least]), row = element("tr");
			$("which").append(element("option", name, { value: i }));
			row.append(element("td", name), element("td", motion.length.toFixed(3)), element("td", nearest === undefined ? "–" : statement(nearest)));
			row.addEventListener("click", () => this.chooseMotion(i));
			$("compare").append(row);
		});
		$("which").addEventListener("change", () => this.chooseMotion(Number($("which").value)));
		this.markMotion(0);
	}

	markMotion(index) {
		$("which").value = index;
		[...$("compare").rows].forEach((row, i) => row.toggleAttribute("aria-current", i === index + 1));
	}

	chooseMotion(index) {
		this.play(false);
		this.model.motion = this.motions[index];
		this.steps = this.model.motion.steps;
		this.markMotion(index);
		this.stage.addTrace(makeTrace(this.stage, this.model, (q) => this.full(q)));
		this.showMotion();
		this.go(this.steps[0].at);
	}

	// ---- several worlds

	makeChapters() {
		$("chapters").hidden = this.model.chapters.length < 2;
		this.model.chapters.forEach((name, i) => $("chapter").append(element("option", `${i + 1}. ${name}`, { value: i })));
		$("chapter").value = chapter;
		$("chapter").addEventListener("change", () => this.openChapter(Number($("chapter").value), false));
	}

	/// Begins the page anew with another world, seen from the same side.
	openChapter(index, play) {
		const next = new URLSearchParams(location.hash.slice(1)), { azimuth, elevation, distance } = this.stage.side();
		next.set("chapter", index);
		next.set("camera", [azimuth, elevation, distance].map((x) => x.toFixed(2)).join(","));
		next.set("theme", document.documentElement.dataset.theme);
		next.delete("at");
		next.delete("play");
		location.hash = next + (play ? "&play" : "");
		location.reload();
	}

	// ---- page

	theme(name) {
		document.documentElement.dataset.theme = name;
		$("theme").textContent = name === "dark" ? "Light" : "Dark";
		this.stage.recolour();
	}

	/// The distance beside the line between the nearest points.
	placeTag(at) {
		$("tag").hidden = at === null || this.tag === "";
		if (at !== null) {
			$("tag").textContent = this.tag;
			const { clientWidth: width, clientHeight: height } = $("stage"), tag = $("tag");
			const x = Math.min(width - tag.offsetWidth - 6, Math.max(6, at.x + 12)), y = Math.min(height - 32, Math.max(6, at.y - 30));
			tag.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
		}
	}

	key(event) {
		const writes = event.target.closest("input, select, textarea"), canvas = event.target === $("canvas");
		const turns = { ArrowLeft: [-8, 0], ArrowRight: [8, 0], ArrowUp: [0, 8], ArrowDown: [0, -8], "+": [0, 0, 0.9], "=": [0, 0, 0.9], "-": [0, 0, 1.1] };
		const motion = { ",": () => this.step(-1), ".": () => this.step(1), m: () => this.go(this.steps[this.model.motion.least].at) };
		if (event.ctrlKey || event.metaKey || event.altKey) {
			return;
		}
		if (canvas && turns[event.key]) {
			this.stage.orbit(...turns[event.key]);
		} else if (event.key === " " && this.steps.length > 1 && !event.target.closest("button, summary, select, input[type=checkbox]")) {
			this.play();
		} else if (event.key === "f" && !writes) {
			this.stage.frame();
		} else if (this.steps.length > 1 && motion[event.key.toLowerCase()]) {
			motion[event.key.toLowerCase()]();
		} else {
			return;
		}
		event.preventDefault();
	}

	listen() {
		let down = null;
		$("canvas").addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; });
		$("canvas").addEventListener("pointerup", (event) => {
			if (down !== null && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 5) {
				const box = $("canvas").getBoundingClientRect();
				this.pick(this.stage.pick(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height));
			}
		});
		for (const kind of ["environment", "self"]) {
			$(`row-${kind}`).addEventListener("click", () => this.choose(kind));
		}
		$("theme").addEventListener("click", () => this.theme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
		document.addEventListener("keydown", (event) => this.key(event));
		new ResizeObserver(() => {
			this.stage.resize();
			this.stage.draw(); // at once: a new size clears the canvas, and the next frame comes after this one is shown
			this.chart?.draw();
			this.curves?.draw();
		}).observe($("stage"));
		this.stage.onDraw = (at) => this.placeTag(at);
	}

	begin() {
		const { model } = this;
		document.title = [model.robot, model.scene].filter((name) => name !== "").join(" · ") + " – leeway";
		$("title").textContent = model.robot || "Robot";
		$("subtitle").textContent = [model.scene, model.group_name === "" ? "" : `group ${model.group_name}`].filter((name) => name !== "").join(" · ");
		$("scale").textContent = "Grid 0.5 m";
		this.stage.pose(this.q);
		this.stage.addTrace(makeTrace(this.stage, model, (q) => this.full(q)));
		this.makeChapters();
		this.makeMotion();
		this.joints = makeJoints(model, this.q, (i, value) => {
			this.q[i] = value;
			this.update(null);
		});
		$("joints-title").textContent = `Joints (${model.group.length})`;
		makeChoices(model, this.stage, (distance) => {
			this.near = distance;
			this.showNear();
		});
		makeNotes(model, false);
		this.listen();
		this.options();
		this.stage.resize();
		this.go(this.startAt);
		this.stage.frame(this.view);
		this.stage.draw();
	}

	/// Of the address: #camera=azimuth,elevation,distance&at=0.5&theme=dark&picture&play
	options() {
		const given = new URLSearchParams(location.hash.slice(1)), camera = (given.get("camera") ?? "").split(",").map(Number);
		this.view = given.has("camera") && camera.every(Number.isFinite) ? { azimuth: camera[0], elevation: camera[1] ?? 20, distance: camera[2] } : null;
		const at = given.get("at") === "least" ? this.steps[this.model.motion.least].at : Number(given.get("at") ?? NaN);
		this.startAt = Number.isFinite(at) ? at : this.steps[0].at;
		if (given.has("picture")) {
			document.body.dataset.picture = "";
			this.stage.still = true;
		}
		for (const name of ["hulls", "spheres", "through", "trace", "ghosts"]) {
			if (given.has(name)) {
				this.stage.show(name, given.get(name) !== "off");
			}
		}
		const dark = given.get("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
		this.theme(dark === "dark" ? "dark" : "light");
	}

	async goLive() {
		const program = await block("program");
		if (program === null || (await block("blob")) === null) {
			return;
		}
		this.engine = await Engine.load(program, await block("numbers"), await block("blob"));
		makeNotes(this.model, true);
		this.update(null);
	}
}

async function start() {
	const mark = document.documentElement.dataset;
	try {
		const page = new Page(readModel(), (await block("bytes")) ?? new ArrayBuffer(0));
		window.leeway = page; // for tests, and for the curious
		page.begin();
		mark.picture = performance.now().toFixed(0);
		await new Promise((resolve) => { setTimeout(resolve, 30); }); // the picture first
		await page.goLive();
		if (new URLSearchParams(location.hash.slice(1)).has("play") && page.steps.length > 1) {
			page.play();
		}
		mark.ready = page.engine === null ? "stored" : "live";
	} catch (error) {
		const message = /webgl/i.test(error.message) ? "This browser shows no 3D pictures: its WebGL is off." : `This page cannot be shown: ${error.message}`;
		$("problem").hidden = false;
		$("problem").textContent = message;
		mark.ready = "failed";
		throw error;
	}
}

start();
