// SPDX-License-Identifier: BSD-3-Clause
// Contrast of texts (WCAG 2.1), and the difference of two colours for the colour-blind.

/// For each visible text of a page: its contrast with the background behind it, and the one that it needs. Runs in the page.
export const legibility = `(() => {
	const parse = (c) => { const n = c.match(/[\\d.]+/g).map(Number); return [n[0], n[1], n[2], n[3] ?? 1]; };
	const linear = (v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
	const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
	const behind = (e) => { for (; e; e = e.parentElement) { const c = parse(getComputedStyle(e).backgroundColor); if (c[3] > 0.5) { return c; } } return [255, 255, 255, 1]; };
	return [...document.querySelectorAll("body *")].filter((e) => e.checkVisibility() && !e.disabled && !e.matches("option, script, style") && [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim() !== "")).map((e) => {
		const style = getComputedStyle(e), text = e instanceof SVGElement ? style.fill : style.color, size = parseFloat(style.fontSize);
		const [a, b] = [luminance(parse(text)), luminance(behind(e))].sort((x, y) => y - x);
		return { text: e.textContent.slice(0, 30), ratio: (a + 0.05) / (b + 0.05), needed: size >= 24 ? 3 : 4.5 };
	});
})()`;

const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);

/// Viénot, Brettel, Mollon 1999: colours as those see them who lack one kind of cone; linear RGB.
const BLIND = {
	protanopia: [[0.11238, 0.88762, 0], [0.11238, 0.88762, 0], [0.00401, -0.00401, 1]],
	deuteranopia: [[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]],
};

function lab([r, g, b]) {
	const f = (t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116);
	const x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505), y = f(0.2126 * r + 0.7152 * g + 0.0722 * b), z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
	return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

/// The least distance in CIE Lab of two colours "#rrggbb", over the kinds of colour blindness.
export function blindDistance(a, b) {
	const rgb = (hex) => [1, 3, 5].map((i) => linear(parseInt(hex.slice(i, i + 2), 16) / 255));
	return Math.min(...Object.values(BLIND).map((matrix) => {
		const seen = (hex) => lab(matrix.map((row) => row.reduce((sum, w, i) => sum + w * rgb(hex)[i], 0)));
		return Math.hypot(...seen(a).map((v, i) => v - seen(b)[i]));
	}));
}
