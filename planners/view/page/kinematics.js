// SPDX-License-Identifier: BSD-3-Clause
// Forward kinematics, as lw_robot_fk(): rigid motions are 12 numbers, a rotation row by row and a translation.

export const IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];
const FIXED = 1, REVOLUTE = 2, CONTINUOUS = 3, PRISMATIC = 4, PLANAR = 5, FLOATING = 6;

export function multiply(a, b) {
	const out = new Array(12);
	for (let i = 0; i < 3; ++i) {
		for (let k = 0; k < 3; ++k) {
			out[3 * i + k] = a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] + a[3 * i + 2] * b[6 + k];
		}
		out[9 + i] = a[3 * i] * b[9] + a[3 * i + 1] * b[10] + a[3 * i + 2] * b[11] + a[9 + i];
	}
	return out;
}

/// Rotation about a unit axis, by Rodrigues' formula.
function turn([x, y, z], angle) {
	const s = Math.sin(angle), c = Math.cos(angle), v = 1 - c;
	return [c + x * x * v, x * y * v - z * s, x * z * v + y * s, y * x * v + z * s, c + y * y * v, y * z * v - x * s,
		z * x * v - y * s, z * y * v + x * s, c + z * z * v, 0, 0, 0];
}

function fromQuaternion([x, y, z, w], t) {
	const n = Math.hypot(x, y, z, w) || 1;
	[x, y, z, w] = [x / n, y / n, z / n, w / n];
	return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
		2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), ...t];
}

/// The joint's own motion for its values.
function motion(joint, values) {
	const length = Math.hypot(...joint.axis) || 1, axis = joint.axis.map((a) => a / length);
	switch (joint.type) {
	case REVOLUTE:
	case CONTINUOUS:
		return turn(axis, values[0]);
	case PRISMATIC:
		return [...IDENTITY.slice(0, 9), ...axis.map((a) => a * values[0])];
	case PLANAR: {
		const [u, v] = planeOf(axis);
		const out = turn(axis, values[2]);
		for (let i = 0; i < 3; ++i) {
			out[9 + i] = u[i] * values[0] + v[i] * values[1];
		}
		return out;
	}
	case FLOATING:
		return fromQuaternion(values.slice(3, 7), values.slice(0, 3));
	case FIXED:
	default:
		return IDENTITY;
	}
}

/// Two axes at right angles to an axis, as the engine has them (Duff et al. 2017).
function planeOf([x, y, z]) {
	const sign = z < 0 || Object.is(z, -0) ? -1 : 1, p = -1 / (sign + z), b = x * y * p;
	return [[1 + sign * x * x * p, sign * b, -sign * x], [b, sign + y * y * p, -y]];
}

/// The value of a joint that follows another one, along the whole chain.
function mimicked(joints, joint, q) {
	return joint.mimic < 0 ? q[joint.variable] ?? 0 : joint.multiplier * mimicked(joints, joints[joint.mimic], q) + joint.offset;
}

function valuesOf(joints, joint, q) {
	const count = joint.type === PLANAR ? 3 : joint.type === FLOATING ? 7 : 1;
	if (joint.type === FIXED) {
		return [];
	}
	return joint.mimic >= 0 ? [mimicked(joints, joint, q)] : Array.from(q.slice(joint.variable, joint.variable + count));
}

/// Poses of all links in the world for a full state.
export function linkPoses(model, q) {
	const poses = new Array(model.links.length).fill(null);
	const above = new Array(model.links.length).fill(null);
	for (const joint of model.joints) {
		above[joint.child] = joint;
	}
	const pose = (link) => {
		if (poses[link] === null) {
			const joint = above[link];
			poses[link] = joint === null ? IDENTITY
				: multiply(multiply(pose(joint.parent), joint.origin), motion(joint, valuesOf(model.joints, joint, q)));
		}
		return poses[link];
	};
	for (let link = 0; link < poses.length; ++link) {
		pose(link);
	}
	return poses;
}

/// The state between two steps: angles without limits take the shorter way.
export function between(model, a, b, t) {
	return a.map((value, i) => {
		const variable = model.variables[model.group[i]];
		let d = b[i] - value;
		if (variable.wraps) {
			d -= 2 * Math.PI * Math.round(d / (2 * Math.PI));
		}
		return value + t * d;
	});
}
