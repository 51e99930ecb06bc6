// SPDX-License-Identifier: BSD-3-Clause
// Numbers with their units.

export function length(metres) {
	if (metres === null || metres === undefined || !Number.isFinite(metres)) {
		return "–";
	}
	return Math.abs(metres) < 1 ? `${(1000 * metres).toFixed(2)} mm` : `${metres.toFixed(4)} m`;
}

export function value(number, unit) {
	return unit === "rad" ? `${number.toFixed(4)} rad (${(180 / Math.PI * number).toFixed(1)}°)` : unit === "m" ? `${number.toFixed(4)} m` : number.toFixed(4);
}

export function place(at, unit) {
	return unit === "seconds" ? `${at.toFixed(2)} s` : unit === "share" ? `${(100 * at).toFixed(1)} %` : `state ${Math.round(at) + 1}`;
}

/// The clearance that is stated: as the reports of the program have it, the lower bound, and below a margin the attained value.
export function stated(clearance) {
	return clearance === null ? null : clearance.upper !== null && clearance.upper <= 0 ? clearance.upper : clearance.lower;
}

/// The same in words. Within a margin the engine ends its search at the first pair that it finds: others may be closer.
export function statement(clearance) {
	const open = clearance.upper !== null && clearance.upper <= 0 && clearance.lower < clearance.upper;
	return `${open ? "at most " : ""}${length(stated(clearance))}`;
}

/// A list of the page's data as a named clearance.
export function clearanceOf(list) {
	return list === null || list === undefined ? null
		: { lower: list[0] ?? Infinity, upper: list[1], a: list[2], b: list[3], margin: list[4], from: list.slice(5, 8), to: list.slice(8, 11) };
}

/// An element with text; names come in by textContent alone.
export function element(tag, text = "", attributes = {}) {
	const out = document.createElement(tag);
	out.textContent = text;
	for (const [name, content] of Object.entries(attributes)) {
		out.setAttribute(name, content);
	}
	return out;
}
