// SPDX-License-Identifier: BSD-3-Clause
// Pairs that keep their distance along the motion: set apart from the numbers and the chart, and always named.
import { element, length } from "./text.js";
import { pairNames } from "./panel.js";

const names = (model, pair) => pairNames(model, pair.self ? "self" : "environment", pair.a, pair.b);

/// The answer for a state without the pairs that are set apart, as long as they keep their distance: a pair that is nearer than along
/// the motion is shown as every other one.
/// @return the answer, and `aside`: the pairs that it leaves out
export function asideOf(model, answer) {
	const out = { ...answer, aside: [] };
	for (const kind of ["environment", "self"]) {
		const nearest = answer[kind], list = model.motion.apart.filter((pair) => (pair.self === 1) === (kind === "self"));
		const slack = (pair) => Math.max(1e-4, 0.01 * pair.least);
		const keeps = list.some((pair) => nearest !== null && pair.a === nearest.a && pair.b === nearest.b && nearest.upper >= pair.least - slack(pair));
		if (keeps) {
			out[kind] = answer.others[kind];
			out.aside.push(...list);
		}
	}
	return out;
}

/// "without 2 pairs that keep their distance (wrist – hand, foot – turret)"; empty without any.
export function describeApart(model, pairs) {
	if (pairs.length === 0) {
		return "";
	}
	const some = pairs.slice(0, 3).map((pair) => names(model, pair)).join(", ") + (pairs.length > 3 ? ", and others" : "");
	return pairs.length === 1 ? `without 1 pair that keeps its distance (${some})` : `without ${pairs.length} pairs that keep their distance (${some})`;
}

/// The pairs with their clearances.
export function showApart(model, list) {
	list.hidden = model.motion.apart.length === 0;
	list.replaceChildren(element("summary", `Set apart: ${model.motion.apart.length === 1 ? "a pair that keeps its distance" : "pairs that keep their distance"}`));
	for (const pair of model.motion.apart) {
		const row = element("p", "", { class: "line" });
		row.append(element("span", names(model, pair)), element("span", pair.most - pair.least < 5e-6 ? length(pair.least) : `${length(pair.least)} to ${length(pair.most)}`, { class: "value" }));
		list.append(row);
	}
}
