// SPDX-License-Identifier: BSD-3-Clause
// Shapes of the page as geometry of three.js.
import { BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, ConeGeometry, CylinderGeometry, InstancedMesh, Matrix4, Mesh, PlaneGeometry,
	SphereGeometry, Vector3, Quaternion } from "three";

const UNBOUNDED = 20; // metres: edge of the square that stands for a plane or half-space

export function matrixOf(pose) {
	return new Matrix4().set(pose[0], pose[1], pose[2], pose[9], pose[3], pose[4], pose[5], pose[10], pose[6], pose[7], pose[8], pose[11], 0, 0, 0, 1);
}

export function meshGeometry(mesh, bytes) {
	const packed = new Uint16Array(bytes, mesh.positions, 3 * mesh.vertices);
	const positions = new Float32Array(packed.length);
	for (let i = 0; i < packed.length; ++i) {
		positions[i] = mesh.low[i % 3] + mesh.size[i % 3] * packed[i] / 65535;
	}
	const geometry = new BufferGeometry();
	geometry.setAttribute("position", new BufferAttribute(positions, 3));
	const indices = mesh.wide ? new Uint32Array(bytes, mesh.indices, 3 * mesh.triangles) : new Uint16Array(bytes, mesh.indices, 3 * mesh.triangles);
	geometry.setIndex(new BufferAttribute(indices, 1));
	return geometry;
}

function primitive(shape) {
	const [x, y, z] = shape.dimensions;
	switch (shape.type) {
	case "box":
		return new BoxGeometry(x, y, z);
	case "sphere":
		return new SphereGeometry(x, 32, 20);
	case "cylinder":
		return new CylinderGeometry(x, x, y, 40).rotateX(Math.PI / 2);
	case "capsule":
		return new CapsuleGeometry(x, y, 10, 32).rotateX(Math.PI / 2);
	case "cone":
		return new ConeGeometry(x, y, 40).rotateX(Math.PI / 2);
	default: // half-space, plane
		return new PlaneGeometry(UNBOUNDED, UNBOUNDED);
	}
}

/// Balls as one object. @param data x, y, z, radius of each
export function balls(data, material, fine = true) {
	const count = data.length / 4, out = new InstancedMesh(new SphereGeometry(1, fine ? 20 : 8, fine ? 12 : 6), material, count);
	const still = new Quaternion();
	for (let i = 0; i < count; ++i) {
		const r = data[4 * i + 3] || 0.002; // a point without radius is drawn with 2 mm
		out.setMatrixAt(i, new Matrix4().compose(new Vector3(data[4 * i], data[4 * i + 1], data[4 * i + 2]), still, new Vector3(r, r, r)));
	}
	return out;
}

function boxes(data, material) {
	const count = data.length / 6, out = new InstancedMesh(new BoxGeometry(1, 1, 1), material, count), still = new Quaternion();
	for (let i = 0; i < count; ++i) {
		const low = new Vector3(...data.slice(6 * i, 6 * i + 3)), high = new Vector3(...data.slice(6 * i + 3, 6 * i + 6));
		out.setMatrixAt(i, new Matrix4().compose(low.clone().add(high).multiplyScalar(0.5), still, high.sub(low)));
	}
	return out;
}

/// Makes objects of shapes; geometry is shared by all uses of a shape.
export class Shapes {
	constructor(list, bytes) {
		this.list = list;
		this.bytes = bytes;
		this.geometry = new Map();
	}

	/// An object of three.js; null for a shape that cannot be shown.
	object(index, material) {
		const shape = this.list[index];
		if (shape.type === "none") {
			return null;
		}
		if (shape.type === "balls") {
			return balls(new Float32Array(this.bytes, shape.data, 4 * shape.count), material, shape.count < 500);
		}
		if (shape.type === "boxes") {
			return boxes(new Float32Array(this.bytes, shape.data, 6 * shape.count), material);
		}
		if (!this.geometry.has(index)) {
			this.geometry.set(index, shape.type === "mesh" ? meshGeometry(shape.mesh, this.bytes) : primitive(shape));
		}
		return new Mesh(this.geometry.get(index), material);
	}

	/// Spheres of a level of its tree, or of the deepest level that the page has; null without any.
	level(index, level, material) {
		const levels = this.list[index].levels ?? [];
		const chosen = levels[Math.min(level, levels.length - 1)];
		return chosen ? balls(new Float32Array(this.bytes, chosen.data, 4 * chosen.count), material) : null;
	}
}
