// SPDX-License-Identifier: BSD-3-Clause
// The engine as WebAssembly: clearances of any state.

const CLEARANCE = 12; // numbers: kind, lower, upper, a, b, margin, two points
const NO_INDEX = 0xffffffff;

/// Functions that a program without files and console needs from its host.
function host(memory) {
	const none = () => 0;
	return {
		env: { emscripten_notify_memory_growth: none },
		wasi_snapshot_preview1: {
			proc_exit: (code) => { throw new Error(`the engine ended with status ${code}`); },
			environ_sizes_get: (count, size) => {
				const view = new DataView(memory().buffer);
				view.setUint32(count, 0, true);
				view.setUint32(size, 0, true);
				return 0;
			},
			environ_get: none, fd_close: none, fd_seek: none, fd_write: none,
		},
	};
}

function text(memory, at) {
	const bytes = new Uint8Array(memory.buffer, at);
	return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
}

function clearance(numbers, at) {
	const [kind, lower, upper, a, b, margin] = numbers.slice(at, at + 6);
	if (kind === 0) {
		return null;
	}
	const index = (i) => (i === NO_INDEX ? -1 : i);
	return { lower, upper: Number.isFinite(upper) ? upper : null, a: index(a), b: index(b), margin,
		from: Array.from(numbers.slice(at + 6, at + 9)), to: Array.from(numbers.slice(at + 9, at + 12)) };
}

export class Engine {
	/// @param program bytes of the WebAssembly module; numbers, blob: bytes of this page
	static async load(program, numbers, blob) {
		let memory = null;
		const { instance } = await WebAssembly.instantiate(program, host(() => memory));
		const calls = instance.exports;
		memory = calls.memory;
		calls._initialize?.();
		const put = (bytes) => {
			const at = calls.lwv_bytes(bytes.byteLength);
			new Uint8Array(memory.buffer, at, bytes.byteLength).set(new Uint8Array(bytes));
			return at;
		};
		const numbers_at = put(numbers), blob_at = put(blob);
		if (calls.lwv_load(numbers_at, numbers.byteLength / 8, blob_at, blob.byteLength) === 0) {
			throw new Error(text(memory, calls.lwv_message()));
		}
		return new Engine(calls, memory);
	}

	constructor(calls, memory) {
		this.calls = calls;
		this.memory = memory;
		this.state_at = calls.lwv_bytes(8 * 4096);
	}

	/// All pairs nearer than a distance, the nearest first, at most 256.
	near(q, flags, distance) {
		new Float64Array(this.memory.buffer, this.state_at, q.length).set(q);
		const at = this.calls.lwv_near(this.state_at, flags, distance), NEAR = 14;
		if (at === 0) {
			throw new Error(text(this.memory, this.calls.lwv_message()));
		}
		const count = new Float64Array(this.memory.buffer, at, 1)[0], numbers = new Float64Array(this.memory.buffer, at + 8, count * NEAR);
		return Array.from({ length: count }, (_, i) => {
			const [self, a, b, lower, upper, ...rest] = numbers.slice(NEAR * i, NEAR * (i + 1));
			return { self: self === 1, a, b, lower, upper, from: rest.slice(0, 3), to: rest.slice(3, 6), normal: rest.slice(6, 9) };
		});
	}

	/// Clearances of a group state, those without the pairs that are set apart, and the pairs in contact.
	measure(q, flags, min_d, touching = true) {
		new Float64Array(this.memory.buffer, this.state_at, q.length).set(q);
		const at = this.calls.lwv_state(this.state_at, flags, min_d, touching ? 1 : 0);
		if (at === 0) {
			throw new Error(text(this.memory, this.calls.lwv_message()));
		}
		const LISTED = 1 + 4 * CLEARANCE, numbers = new Float64Array(this.memory.buffer, at, LISTED + 1 + 3 * 64);
		const count = numbers[LISTED], pairs = [];
		for (let i = 0; i < count; ++i) {
			pairs.push(Array.from(numbers.slice(LISTED + 1 + 3 * i, LISTED + 4 + 3 * i)));
		}
		const both = (begin) => ({ environment: clearance(numbers, begin), self: clearance(numbers, begin + CLEARANCE) });
		return { ...both(1), others: both(1 + 2 * CLEARANCE), touching: pairs };
	}
}
