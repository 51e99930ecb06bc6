// SPDX-License-Identifier: BSD-3-Clause
// All near pairs of the state: a line between the nearest points of each, and an arrow at the first link, the way out.
import { BufferAttribute, BufferGeometry, Color, ConeGeometry, DynamicDrawUsage, Group, InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, MeshBasicMaterial, Quaternion, Vector3 } from "three";

const MOST = 256, SHAFT = 0.06, HEAD = 0.02; // metres
const CONE_AXIS = new Vector3(0, 1, 0);

export class NearArrows {
	constructor() {
		const lines = new BufferGeometry();
		for (const name of ["position", "color"]) {
			lines.setAttribute(name, new BufferAttribute(new Float32Array(3 * 4 * MOST), 3).setUsage(DynamicDrawUsage));
		}
		this.lines = new LineSegments(lines, new LineBasicMaterial({ vertexColors: true, depthTest: false, transparent: true }));
		this.heads = new InstancedMesh(new ConeGeometry(HEAD / 3, HEAD, 12).translate(0, HEAD / 2, 0), new MeshBasicMaterial({ depthTest: false, transparent: true }), MOST);
		this.group = new Group();
		this.group.add(this.lines, this.heads);
		for (const part of this.group.children) {
			part.frustumCulled = false;
			part.renderOrder = 2;
		}
		this.show([], 1);
	}

	recolour(near, far) {
		[this.near, this.far] = [near, far];
	}

	/// @param pairs of Engine.near(); distance: metres, at which the colour is that of far pairs
	show(pairs, distance) {
		const { position, color } = this.lines.geometry.attributes, matrix = new Matrix4(), turn = new Quaternion(), one = new Vector3(1, 1, 1);
		const shown = pairs.filter((pair) => pair.normal.some((x) => x !== 0)).slice(0, MOST);
		shown.forEach((pair, i) => {
			const out = new Vector3(...pair.normal), at = new Vector3(...pair.from), tip = at.clone().addScaledVector(out, SHAFT);
			const tint = new Color().lerpColors(this.near, this.far, Math.min(1, Math.max(0, pair.upper / distance)));
			[pair.to, pair.from, pair.from, tip.toArray()].forEach((point, k) => {
				position.array.set(point, 3 * (4 * i + k));
				color.array.set(tint.toArray(), 3 * (4 * i + k));
			});
			this.heads.setMatrixAt(i, matrix.compose(tip, turn.setFromUnitVectors(CONE_AXIS, out), one));
			this.heads.setColorAt(i, tint);
		});
		this.lines.geometry.setDrawRange(0, 4 * shown.length);
		this.heads.count = shown.length;
		position.needsUpdate = color.needsUpdate = this.heads.instanceMatrix.needsUpdate = true;
		if (this.heads.instanceColor) {
			this.heads.instanceColor.needsUpdate = true;
		}
		this.group.visible = shown.length > 0;
	}
}
