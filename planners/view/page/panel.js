// SPDX-License-Identifier: BSD-3-Clause
// The panel beside the picture: clearance, joints, choices, notes.
import { holds } from "./data.js";
import { element, length, stated, statement, value } from "./text.js";

export function pairNames(model, kind, a, b) {
	const link = (i) => model.links[i] ?? "–";
	return kind === "self" ? `${link(a)} – ${link(b)}` : `${link(a)} – ${model.objects[b] ?? "–"}`;
}

/// Free, too close, within a margin, in contact, or not decided.
export function verdictOf(answer, min_d) {
	const values = [answer.environment, answer.self].filter((c) => c !== null);
	if (values.length === 0) {
		return { text: "not measured", bad: false };
	}
	const least = Math.min(...values.map((c) => c.lower)), attained = Math.min(...values.map((c) => c.upper ?? Infinity));
	const distance = Math.min(...values.map((c) => (c.upper === null ? Infinity : c.upper + c.margin)));
	return least > min_d ? { text: "● free", bad: false }
		: distance <= 0 ? { text: "▲ in contact", bad: true } : attained <= 0 ? { text: "▲ in the margin", bad: true }
			: attained <= min_d ? { text: "▲ too close", bad: true } : { text: "◆ not decided", bad: true };
}

function fillRow(row, model, kind, clearance) {
	row.replaceChildren(element("span", kind === "self" ? "Between links" : "To obstacles", { class: "kind" }));
	const known = clearance !== null && clearance.a >= 0 && clearance.b >= 0 && clearance.upper !== null;
	row.append(element("span", clearance === null ? "not asked" : known ? statement(clearance) : kind === "environment" && model.placed.length === 0 ? "no obstacles" : "none in range", { class: "value" }));
	row.append(element("span", known ? pairNames(model, kind, clearance.a, clearance.b) : "", { class: "pair" }));
	if (known && clearance.margin > 0) {
		row.append(element("span", `distance ${length(clearance.upper + clearance.margin)}, less the margin of ${length(clearance.margin)}`, { class: "kind" }));
	}
	row.disabled = !known;
}

export function showAnswer(model, answer, note) {
	const $ = (id) => document.getElementById(id);
	const asked = [answer.environment, answer.self].filter((c) => c !== null).sort((a, b) => stated(a) - stated(b));
	const verdict = verdictOf(answer, model.min_d);
	$("clearance").textContent = asked.length > 0 ? statement(asked[0]) : "–";
	$("clearance").classList.toggle("long", $("clearance").textContent.length > 12);
	$("verdict").textContent = verdict.text;
	$("verdict").classList.toggle("bad", verdict.bad);
	$("verdict-note").textContent = [model.min_d > 0 ? `required: more than ${length(model.min_d)}` : "", note].filter((t) => t !== "").join("; ");
	for (const kind of ["environment", "self"]) {
		fillRow($(`row-${kind}`), model, kind, answer[kind]);
		$(`row-${kind}`).classList.toggle("bad", answer[kind] !== null && answer[kind].upper !== null && answer[kind].upper <= model.min_d);
	}
}

/// Sliders of the group's joints. Joints without limits get a range around the start.
export function makeJoints(model, q, changed) {
	const list = document.getElementById("joint-list");
	return model.variables.map((variable, i) => {
		if (!variable.group) {
			return null;
		}
		const unbounded = variable.unit === "" ? 1 : variable.unit === "rad" ? Math.PI : 2, around = variable.unit === "m" ? q[i] : 0;
		const row = element("div", "", { class: "joint" }), id = `joint-${i}`;
		const input = element("input", "", { type: "range", id, step: "any", min: variable.lower ?? around - unbounded, max: variable.upper ?? around + unbounded });
		const output = element("output", "", { for: id });
		const show = (x) => {
			input.value = x;
			output.textContent = value(x, variable.unit);
		};
		input.addEventListener("input", () => {
			output.textContent = value(Number(input.value), variable.unit);
			changed(i, Number(input.value));
		});
		row.append(element("label", variable.name, { for: id }), output, input);
		list.append(row);
		show(q[i]);
		return show;
	});
}

function checkbox(text, checked, changed, swatch = "") {
	const row = element("label", "", { class: "choice" }), input = element("input", "", { type: "checkbox" });
	input.checked = checked;
	input.addEventListener("change", () => changed(input.checked));
	row.append(input, element("span", text));
	if (swatch !== "") {
		const mark = element("span", "", { class: "swatch" });
		mark.style.background = `var(${swatch})`;
		row.append(mark);
	}
	return row;
}

/// A row with a choice of one of [value, text].
function selectRow(text, options, changed) {
	const row = element("label", "", { class: "choice" }), select = element("select", "", { "aria-label": text });
	select.append(...options.map(([value, name]) => element("option", name, { value })));
	select.addEventListener("change", () => changed(Number(select.value)));
	row.append(element("span", text), select);
	return row;
}

/// @param near called with the distance in metres below which pairs are shown; 0: none
export function makeChoices(model, stage, near) {
	const show = document.getElementById("show"), add = (name, text, swatch) =>
		show.append(checkbox(text, stage.visible[name], (on) => stage.show(name, on), swatch));
	add("robot", "Robot", "--robot");
	if (model.placed.length > 0) {
		add("obstacles", "Obstacles", "--obstacle");
		add("through", "See through obstacles");
	}
	if (stage.own.link.size + stage.own.object.size > 0) {
		add("colours", "Colours of the files");
	}
	add("witness", "Line between the nearest points", "--ink");
	if (stage.motion) {
		add("trace", "Path of the tip; red: nearest to contact", "--accent");
		add("ghosts", "Ghosts of start and goal");
	}
	if (model.hulls.length > 0) {
		add("hulls", "Motion hulls: all places of the chosen link, or of all links");
	}
	if (model.spheres.length > 0) {
		const excess = Math.max(...model.spheres.map((set) => set.excess));
		add("spheres", `Enclosing spheres, at most ${length(excess)} beyond the links`);
	}
	const levels = Math.max(0, ...model.bodies.map((body) => model.shapes[body.shape].levels?.length ?? 0));
	if (levels > 0) {
		const choices = Array.from({ length: levels }, (_, level) => [level, level === 0 ? "one sphere" : `level ${level}`]);
		show.append(selectRow("Sphere trees of the search", [[-1, "off"], ...choices], (level) => stage.show("level", level)));
	}
	if (holds("program") && holds("blob")) {
		show.append(selectRow("Way out of near pairs", [[0, "off"], ...[0.01, 0.05, 0.2].map((d) => [d, `nearer than ${length(d)}`])], near));
	}
}

function items(title, lines) {
	const list = element("ul");
	list.append(...lines.map((line) => element("li", line)));
	return [element("p", title), list];
}

export function makeNotes(model, live) {
	const notes = document.getElementById("notes"), files = Object.values(model.files).filter((name) => name !== "");
	notes.replaceChildren(element("p", `Written by ${model.program}. Shown is the collision geometry, in metres.`));
	if (files.length > 0) {
		notes.append(...items("Files:", files));
	}
	notes.append(element("p", live ? "Clearances of this page are computed in it by the same engine." :
		"Clearances were computed when the page was written. Joints that you move by hand are shown without a clearance."));
	if (model.omitted.length > 0) {
		notes.append(...items("Simplified or not shown:", model.omitted));
	}
	if (model.empty_links?.length > 0) {
		notes.append(element("p", `Links without collision geometry: ${model.empty_links.map((i) => model.links[i]).join(", ")}.`));
	}
	if (model.notes.length > 0) {
		notes.append(...items("Notices:", model.notes));
	}
	notes.append(element("p", "Keys: Space plays, comma and full stop step, M goes to the smallest clearance, F frames the robot; with the picture in focus, arrow keys turn it, plus and minus zoom."));
}
