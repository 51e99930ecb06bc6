// SPDX-License-Identifier: BSD-3-Clause
// Clearances along a motion as a picture of lines; a click goes to the place.
import { clearanceOf, place, stated } from "./text.js";
import { nearestPart } from "./trace.js";

export const LEFT = 60, RIGHT = 8;
const SVG = "http://www.w3.org/2000/svg", TOP = 8, BOTTOM = 22;

export function node(parent, tag, attributes, text = "") {
	const out = document.createElementNS(SVG, tag);
	for (const [name, value] of Object.entries(attributes)) {
		out.setAttribute(name, value);
	}
	out.textContent = text;
	parent.append(out);
	return out;
}

/// A round number of which about three fit.
function tick(span) {
	const size = 10 ** Math.floor(Math.log10(span / 3));
	return [1, 2, 5, 10].map((f) => f * size).find((s) => span / s <= 4);
}

export class Chart {
	constructor(svg, model, go) {
		this.svg = svg;
		this.min_d = model.min_d;
		this.show(model.motion, []);
		const drag = (event) => {
			const x = (event.clientX - svg.getBoundingClientRect().left - LEFT) / (this.width - LEFT - RIGHT);
			const [first, last] = this.ends();
			go(first + Math.min(1, Math.max(0, x)) * (last - first));
		};
		svg.addEventListener("pointerdown", (event) => {
			svg.setPointerCapture(event.pointerId);
			drag(event);
		});
		svg.addEventListener("pointermove", (event) => event.buttons > 0 && drag(event));
	}

	/// @param others motions whose least clearances are drawn pale
	show(motion, others) {
		const of = (one, name) => one.steps.map((step) => stated(clearanceOf((step.others ?? step)[name])));
		this.motion = motion;
		this.series = ["environment", "self"].map((name) => ({ name, values: of(motion, name) }));
		this.others = others.map((one) => {
			const [environment, self] = ["environment", "self"].map((name) => of(one, name));
			return one.steps.map((step, i) => ({ at: step.at, value: Math.min(environment[i] ?? Infinity, self[i] ?? Infinity) })).filter((p) => Number.isFinite(p.value));
		});
		this.at = undefined;
	}

	/// Times of several motions share one axis.
	ends() {
		const last = this.motion.unit === "seconds" ? Math.max(...this.others.flat().map((p) => p.at), this.motion.steps.at(-1).at) : this.motion.steps.at(-1).at;
		return [this.motion.steps[0].at, last];
	}

	x(at) {
		const [first, last] = this.ends();
		return LEFT + (at - first) / (last - first || 1) * (this.width - LEFT - RIGHT);
	}

	y(value) {
		return TOP + (this.high - Math.min(value, this.high)) / (this.high - this.low) * (this.height - TOP - BOTTOM);
	}

	draw() {
		this.width = this.svg.clientWidth || 320;
		this.height = this.svg.clientHeight || 150;
		this.svg.replaceChildren();
		this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
		const finite = [...this.series.flatMap((series) => series.values), ...this.others.flat().map((p) => p.value)].filter((value) => Number.isFinite(value));
		this.low = Math.min(0, ...finite);
		this.high = Math.max(1e-3, this.min_d * 1.2, ...finite) * 1.05;
		this.nearest();
		this.axes();
		for (const other of this.others) {
			node(this.svg, "polyline", { class: "other", points: other.map((p) => `${this.x(p.at).toFixed(1)},${this.y(p.value).toFixed(1)}`).join(" ") });
		}
		for (const { name, values } of this.series) {
			const points = values.map((value, i) => (Number.isFinite(value) ? `${this.x(this.motion.steps[i].at).toFixed(1)},${this.y(value).toFixed(1)}` : null));
			if (points.some((point) => point !== null)) {
				node(this.svg, "polyline", { class: name, points: points.filter((point) => point !== null).join(" ") });
			}
		}
		if (this.min_d > 0) {
			node(this.svg, "line", { class: "required", x1: LEFT, x2: this.width - RIGHT, y1: this.y(this.min_d), y2: this.y(this.min_d) });
		}
		const least = this.motion.steps[this.motion.least], values = this.series.map((series) => series.values[this.motion.least]).filter(Number.isFinite);
		if (values.length > 0) {
			node(this.svg, "circle", { class: "minimum", cx: this.x(least.at), cy: this.y(Math.min(...values)), r: 5 });
		}
		this.now = node(this.svg, "line", { class: "now", x1: 0, x2: 0, y1: TOP, y2: this.height - BOTTOM });
		this.mark(this.at ?? this.ends()[0]);
	}

	/// A band behind the part that is nearest to contact, as it is red along the path.
	nearest() {
		const part = nearestPart(this.motion);
		if (part !== null) {
			const [left, right] = part.map((step) => this.x(this.motion.steps[step].at));
			node(this.svg, "rect", { class: "nearest", x: left - 1, y: TOP, width: right - left + 2, height: this.height - TOP - BOTTOM });
		}
	}

	axes() {
		const step = tick(this.high - this.low), metres = this.high >= 1;
		for (let value = Math.ceil(this.low / step) * step; value <= this.high; value += step) {
			const y = this.y(value), shown = metres ? value : 1000 * value;
			node(this.svg, "line", { class: "axis", x1: LEFT, x2: this.width - RIGHT, y1: y, y2: y });
			node(this.svg, "text", { x: LEFT - 6, y: y + 4, "text-anchor": "end" }, `${+shown.toPrecision(4)} ${metres ? "m" : "mm"}`);
		}
		const [first, last] = this.ends();
		node(this.svg, "text", { x: LEFT, y: this.height - 6 }, place(first, this.motion.unit));
		node(this.svg, "text", { x: this.width - RIGHT, y: this.height - 6, "text-anchor": "end" }, place(last, this.motion.unit));
	}

	mark(at) {
		this.at = at;
		for (const end of ["x1", "x2"]) {
			this.now?.setAttribute(end, this.x(at));
		}
	}
}
