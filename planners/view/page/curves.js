// SPDX-License-Identifier: BSD-3-Clause
// Numbers along the motion beside its clearances, one below the other over the chart's axis: speed scales, ages.
import { LEFT, RIGHT, node } from "./chart.js";

const LANE = 52, ROOM = 18; // pixels: of a curve with its name, above its line

export class Curves {
	/// @param chart whose axis the curves share
	constructor(svg, model, chart) {
		this.svg = svg;
		this.chart = chart;
		this.motion = model.motion;
		this.curves = model.curves ?? [];
		svg.toggleAttribute("hidden", this.curves.length === 0);
		svg.style.height = `${LANE * this.curves.length}px`;
	}

	draw() {
		this.svg.replaceChildren();
		const width = this.svg.clientWidth || 320;
		this.svg.setAttribute("viewBox", `0 0 ${width} ${LANE * this.curves.length}`);
		this.curves.forEach(({ name, unit, values }, lane) => {
			const known = values.filter((value) => value !== null), most = Math.max(...known, 0) || 1, bottom = LANE * (lane + 1) - 4;
			const y = (value) => bottom - value / most * (LANE - ROOM - 4);
			const shown = `${+most.toPrecision(3)} ${unit}`.trim();
			node(this.svg, "text", { x: LEFT, y: bottom - LANE + ROOM }, name);
			node(this.svg, "text", { x: LEFT - 6, y: y(most) + 6, "text-anchor": "end" }, shown);
			node(this.svg, "line", { class: "axis", x1: LEFT, x2: width - RIGHT, y1: bottom, y2: bottom });
			const points = values.map((value, i) => (value === null ? null : `${this.chart.x(this.motion.steps[i].at).toFixed(1)},${y(value).toFixed(1)}`));
			node(this.svg, "polyline", { class: "curve", points: points.filter((point) => point !== null).join(" ") });
		});
		this.now = node(this.svg, "line", { class: "now", y1: 0, y2: LANE * this.curves.length });
		this.mark(this.chart.at ?? this.chart.ends()[0]);
	}

	mark(at) {
		for (const end of ["x1", "x2"]) {
			this.now?.setAttribute(end, this.chart.x(at));
		}
	}
}
