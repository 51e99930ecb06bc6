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

/// Of several worlds the one that the address names: page.html#chapter=1. The first has the blocks model, bytes, ..., the second model-1, bytes-1, ...
export const chapter = Number(new URLSearchParams(location.hash.slice(1)).get("chapter") ?? 0);

/// The block of this world; of a name that all of them share, or of a world that the page does not have, that of the first.
function find(id) {
	return (chapter > 0 ? document.getElementById(`${id}-${chapter}`) : null) ?? document.getElementById(id);
}

/// True if the page has this block, and something in it.
export function holds(id) {
	return (find(id)?.textContent ?? "") !== "";
}

/// The bytes of a data block; null if the page has none of this name.
export async function block(id) {
	if (!holds(id)) {
		return null;
	}
	const stream = new Blob([fromBase64(find(id).textContent)]).stream().pipeThrough(new DecompressionStream("gzip"));
	return new Response(stream).arrayBuffer();
}

export function model() {
	return JSON.parse(find("model").textContent);
}
