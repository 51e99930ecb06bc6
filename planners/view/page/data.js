// SPDX-License-Identifier: BSD-3-Clause
// The data blocks of the page: JSON, and compressed bytes as base64.

function fromBase64(text) {
	const binary = atob(text);
	const bytes = new Uint8Array(binary.length);
	for (let i = 0; i < binary.length; ++i) {
		bytes[i] = binary.charCodeAt(i);
	}
	return bytes;
}

/// The bytes of a data block; null if the page has none of this name.
export async function block(id) {
	const text = document.getElementById(id)?.textContent ?? "";
	if (text === "") {
		return null;
	}
	const stream = new Blob([fromBase64(text)]).stream().pipeThrough(new DecompressionStream("gzip"));
	return new Response(stream).arrayBuffer();
}

export function model() {
	return JSON.parse(document.getElementById("model").textContent);
}
