// SPDX-License-Identifier: BSD-3-Clause
// A motion in the picture: the path of the tips, the part of it that is nearest to contact, ghosts of start and goal.
import { Box3, CatmullRomCurve3, Group, Mesh, TubeGeometry, Vector3 } from "three";
import { matrixOf } from "./geometry.js";
import { linkPoses, multiply } from "./kinematics.js";
import { clearanceOf, stated } from "./text.js";

const NEAREST = 0.1;     // of the range of clearances: the part nearest to contact lies within this above the smallest
const APART = 1e-4;      // metres between two points of a tube, at least
const RADIUS = 0.006;    // of a tube, as a share of the robot's size

/// The smaller clearance of a step, without pairs that are set apart; infinite if nothing was measured.
export function leastOf(step) {
	const from = step.others ?? step, values = ["environment", "self"].map((kind) => stated(clearanceOf(from[kind]))).filter((value) => value !== null);
	return Math.min(Infinity, ...values);
}

/// First and last step of the part around the smallest clearance that is nearest to contact; null where nothing is near.
export function nearestPart(motion) {
	const values = motion.steps.map(leastOf), finite = values.filter(Number.isFinite), least = values[motion.least];
	if (motion.steps.length < 2 || motion.unit === "state" || !Number.isFinite(least)) {
		return null;
	}
	const most = least + NEAREST * (finite.reduce((a, b) => Math.max(a, b)) - least);
	let [first, last] = [motion.least, motion.least];
	while (first > 0 && values[first - 1] <= most) {
		--first;
	}
	while (last + 1 < values.length && values[last + 1] <= most) {
		++last;
	}
	return [first, last];
}

/// The last link of each chain of the group, and on from there through fixed joints.
export function tipsOf(model) {
	const moves = (joint) => model.group.includes(joint.mimic < 0 ? joint.variable : model.joints[joint.mimic].variable) && joint.type !== 1;
	const below = (link) => model.joints.filter((joint) => joint.parent === link);
	const deeper = (link) => below(link).some((joint) => moves(joint) || deeper(joint.child));
	const onward = (link) => {
		const fixed = below(link).filter((joint) => joint.type === 1);
		return fixed.length === 1 && below(link).length === 1 ? onward(fixed[0].child) : link;
	};
	return model.joints.filter((joint) => moves(joint) && !deeper(joint.child)).map((joint) => onward(joint.child));
}

/// Links that the group moves.
function movedLinks(model) {
	const above = new Map(model.joints.map((joint) => [joint.child, joint]));
	const moved = (link) => {
		const joint = above.get(link);
		return joint !== undefined && ((joint.type !== 1 && model.group.includes(joint.mimic < 0 ? joint.variable : model.joints[joint.mimic].variable)) || moved(joint.parent));
	};
	return model.links.map((_, link) => link).filter(moved);
}

function tube(points, radius, material) {
	const apart = points.filter((point, i) => i === 0 || point.distanceTo(points[i - 1]) > APART);
	return apart.length < 2 ? null : new Mesh(new TubeGeometry(new CatmullRomCurve3(apart), 2 * apart.length, radius, 6), material);
}

/// The middle of a link's shapes in its frame; the frame's origin without any.
function middleOf(stage, link) {
	const box = new Box3();
	stage.links[link].bodies.children.forEach((body) => {
		body.geometry.computeBoundingBox();
		box.union(body.geometry.boundingBox.clone().applyMatrix4(body.matrix));
	});
	return box.isEmpty() ? new Vector3() : box.getCenter(new Vector3());
}

/// @param full the state of a step as one of all joints
/// @return { trace, ghosts }: two groups; null for one state and for lists of states
export function makeTrace(stage, model, full) {
	const { motion } = model;
	if (motion.steps.length < 2 || motion.unit === "state") {
		return null;
	}
	const trace = new Group(), ghosts = new Group(), poses = motion.steps.map((step) => linkPoses(model, full(step.q)));
	const radius = RADIUS * stage.robotBox().getSize(new Vector3()).length() / 2, part = nearestPart(motion);
	for (const link of tipsOf(model)) {
		const middle = middleOf(stage, link), points = poses.map((pose) => middle.clone().applyMatrix4(matrixOf(pose[link])));
		const near = part === null ? null : tube(points.slice(Math.max(0, part[0] - 1), part[1] + 2), 1.6 * radius, stage.materials.nearest);
		trace.add(...[tube(points, radius, stage.materials.trace), near].filter((object) => object !== null));
	}
	const moved = new Set(movedLinks(model));
	for (const [pose, material] of [[poses[0], stage.materials.start], [poses.at(-1), stage.materials.goal]]) {
		for (const body of model.bodies.filter((entry) => moved.has(entry.link))) {
			stage.place(ghosts, stage.shapes.object(body.shape, material), multiply(pose[body.link], body.pose), {});
		}
	}
	return { trace, ghosts };
}
