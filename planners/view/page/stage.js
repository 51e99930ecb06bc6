// SPDX-License-Identifier: BSD-3-Clause
// The picture: robot, obstacles, overlays, camera. It is drawn when something changed, and not otherwise.
import { BufferAttribute, BufferGeometry, Box3, Color, DirectionalLight, DoubleSide, GridHelper, Group, HemisphereLight, LineBasicMaterial, LineSegments, Mesh,
	MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Raycaster, SRGBColorSpace, Scene, SphereGeometry, Spherical, Vector2, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Shapes, balls, matrixOf, meshGeometry } from "./geometry.js";
import { linkPoses } from "./kinematics.js";
import { NearArrows } from "./near.js";

const UP = new Vector3(0, 0, 1);
const SLOW = 50;          // milliseconds per frame from which moving pictures become coarser
const CONTINUOUS = 1500;  // milliseconds between two frames of one movement, at most
const BEGIN = 6;          // frames of a movement before it becomes coarser
const STILL = 250;        // milliseconds after which a picture is drawn in full again
const COARSEST = 0.35;    // share of the full resolution

function solid(options = {}) {
	return new MeshLambertMaterial({ flatShading: true, side: DoubleSide, ...options });
}

function glass(opacity) {
	return new MeshLambertMaterial({ transparent: true, opacity, depthWrite: false });
}

/// Materials by index of link or object. A shape stays visible: opacity is at least 0.2.
function ownMaterials(colours) {
	return new Map((colours ?? []).map(({ of, rgba: [r, g, b, a] }) => {
		const opacity = Math.max(0.2, Math.min(1, a)), material = solid({ transparent: opacity < 1, opacity, depthWrite: opacity >= 1 });
		material.color.setRGB(r, g, b, SRGBColorSpace);
		material.userData.opacity = opacity;
		return [of, material];
	}));
}

/// Behind the solid links where both coincide.
function ghost() {
	return Object.assign(glass(0.2), { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 });
}

export class Stage {
	constructor(canvas, model, bytes) {
		this.model = model;
		this.bytes = bytes;
		this.renderer = new WebGLRenderer({ canvas, antialias: true });
		this.full = Math.min(2, window.devicePixelRatio || 1);
		this.renderer.setPixelRatio(this.full);
		Object.assign(this, { drawn: -Infinity, run: 0, pace: 0, moving: 1, shown: 1, still: false });
		this.scene = new Scene();
		this.camera = new PerspectiveCamera(40, 1, 0.01, 200);
		this.camera.up.copy(UP);
		this.controls = new OrbitControls(this.camera, canvas);
		this.controls.addEventListener("change", () => this.request());
		this.frames = 0;
		this.materials = { robot: solid(), obstacle: solid(), touching: solid(), chosen: solid(), tree: glass(0.22), hull: glass(0.1), spheres: glass(0.4), margin: glass(0.25),
			trace: new MeshBasicMaterial(), nearest: new MeshBasicMaterial({ depthTest: false, transparent: true }), start: ghost(), goal: ghost() };
		this.own = { link: ownMaterials(model.link_colours), object: ownMaterials(model.object_colours) }; // of the files
		this.light = new DirectionalLight(0xffffff, 1.3);
		const sky = new HemisphereLight(0xffffff, 0x7d838c, 1.9);
		sky.position.copy(UP);
		this.scene.add(sky, this.light, this.light.target);
		this.shapes = new Shapes(model.shapes, bytes);
		this.visible = { robot: true, obstacles: true, witness: true, hulls: false, spheres: model.spheres.length > 0, level: -1, through: false, trace: true, ghosts: true, colours: true };
		this.build();
	}

	build() {
		const { model } = this;
		this.links = model.links.map(() => {
			const link = { frame: new Group(), bodies: new Group(), tree: new Group(), hulls: new Group(), spheres: new Group() };
			link.frame.matrixAutoUpdate = false;
			link.frame.add(link.bodies, link.tree, link.hulls, link.spheres);
			this.scene.add(link.frame);
			return link;
		});
		for (const body of model.bodies) {
			this.place(this.links[body.link].bodies, this.shapes.object(body.shape, this.materials.robot), body.pose, { link: body.link });
		}
		this.obstacles = new Group();
		this.scene.add(this.obstacles);
		for (const placed of model.placed) {
			this.place(this.obstacles, this.shapes.object(placed.shape, this.materials.obstacle), placed.pose, { object: placed.object });
		}
		for (const hull of model.hulls) {
			const object = new Mesh(meshGeometry(hull.mesh, this.bytes), this.materials.hull);
			object.userData = { hull: hull.link };
			this.links[hull.parent].hulls.add(object);
		}
		for (const set of model.spheres) {
			this.links[set.link].spheres.add(balls(new Float32Array(this.bytes, set.data, 4 * set.count), this.materials.spheres));
		}
		this.witness = new Group();
		this.scene.add(this.witness);
		this.makeWitness();
		this.arrows = new NearArrows();
		this.scene.add(this.arrows.group);
		this.show("robot", true);
	}

	place(group, object, pose, owner) {
		if (object !== null) {
			object.matrixAutoUpdate = false;
			object.matrix.copy(matrixOf(pose));
			object.userData = owner;
			group.add(object);
		}
	}

	/// The path of the tips and the ghosts. @param made by makeTrace(); null: none
	addTrace(made) {
		if (this.motion) {
			this.scene.remove(this.motion.trace, this.motion.ghosts);
		}
		this.motion = made;
		if (made !== null) {
			this.scene.add(made.trace, made.ghosts);
			this.show("trace", this.visible.trace);
		}
	}

	makeWitness() {
		const line = new BufferGeometry();
		line.setAttribute("position", new BufferAttribute(new Float32Array(6), 3));
		this.line_material = new LineBasicMaterial({ depthTest: false, transparent: true });
		this.dot_material = new MeshBasicMaterial({ depthTest: false, transparent: true });
		this.line = new LineSegments(line, this.line_material);
		this.line.frustumCulled = false;
		this.dots = [0, 1].map(() => new Mesh(new SphereGeometry(1, 16, 10), this.dot_material));
		this.line.renderOrder = 2;
		this.ball = new Mesh(new SphereGeometry(1, 32, 20), this.materials.margin);
		this.witness.add(this.line, this.ball, ...this.dots);
		this.dots.forEach((dot) => { dot.renderOrder = 3; });
	}

	/// Colours of the page's style.
	recolour() {
		const style = getComputedStyle(document.documentElement), colour = (name) => new Color(style.getPropertyValue(name).trim());
		this.scene.background = colour("--stage");
		this.materials.robot.color = colour("--robot");
		this.materials.obstacle.color = colour("--obstacle");
		this.materials.touching.color = colour("--danger");
		this.materials.chosen.color = colour("--accent");
		this.materials.tree.color = colour("--accent");
		this.materials.hull.color = colour("--accent");
		this.materials.spheres.color = colour("--accent");
		this.materials.margin.color = colour("--danger");
		this.materials.trace.color = colour("--accent");
		this.materials.nearest.color = colour("--danger");
		this.materials.start.color = colour("--good");
		this.materials.goal.color = colour("--accent");
		this.arrows.recolour(colour("--danger"), colour("--accent"));
		this.line_material.color = colour("--ink");
		this.dot_material.color = colour("--ink");
		this.grid?.removeFromParent();
		this.grid = new GridHelper(8, 16, colour("--grid"), colour("--grid"));
		this.grid.rotation.x = Math.PI / 2;
		this.grid.position.z = this.floor ?? 0;
		this.scene.add(this.grid);
		this.request();
	}

	pose(q) {
		linkPoses(this.model, q).forEach((pose, i) => {
			this.links[i].frame.matrix.copy(matrixOf(pose));
			this.links[i].frame.matrixWorldNeedsUpdate = true;
		});
		this.request();
	}

	/// @param touching pairs in contact; chosen: { links, objects } to emphasise
	paint(touching, chosen) {
		this.painted = [touching, chosen];
		const own = (kind, i) => (this.visible.colours ? this.own[kind].get(i) : undefined);
		const red_links = new Set(), red_objects = new Set();
		for (const [self, a, b] of touching) {
			red_links.add(a);
			(self ? red_links : red_objects).add(b);
		}
		const material = (is_red, is_chosen, plain) => (is_red ? this.materials.touching : is_chosen ? this.materials.chosen : plain);
		this.links.forEach((link, i) => link.bodies.children.forEach((body) => {
			body.material = material(red_links.has(i), chosen.links.includes(i), own("link", i) ?? this.materials.robot);
		}));
		for (const body of this.obstacles.children) {
			const i = body.userData.object;
			body.material = material(red_objects.has(i), chosen.objects.includes(i), own("object", i) ?? this.materials.obstacle);
		}
		this.request();
	}

	/// Motion hulls of one link, or of all.
	onlyHull(link) {
		const hulls = this.links.flatMap((entry) => entry.hulls.children), has = hulls.some((hull) => hull.userData.hull === link);
		hulls.forEach((hull) => { hull.visible = !has || hull.userData.hull === link; });
	}

	/// The nearest pair's points, and a ball of its margin around the second; null: none.
	showWitness(pair) {
		this.pair = pair;
		if (pair !== null) {
			this.line.geometry.attributes.position.array.set([...pair.from, ...pair.to]);
			this.line.geometry.attributes.position.needsUpdate = true;
			this.dots[0].position.set(...pair.from);
			this.dots[1].position.set(...pair.to);
			this.ball.visible = pair.margin > 0;
			this.ball.position.set(...pair.to);
			this.ball.scale.setScalar(pair.margin || 1);
		}
		this.request();
	}

	/// @param pairs of Engine.near()
	showNear(pairs, distance) {
		this.arrows.show(pairs, distance);
		this.request();
	}

	show(name, value) {
		this.visible[name] = value;
		for (const link of this.links) {
			link.bodies.visible = this.visible.robot;
			link.hulls.visible = this.visible.hulls;
			link.spheres.visible = this.visible.spheres;
		}
		this.obstacles.visible = this.visible.obstacles;
		for (const part of ["trace", "ghosts"].filter(() => this.motion)) {
			this.motion[part].visible = this.visible[part];
		}
		for (const material of [this.materials.obstacle, ...this.own.object.values()]) {
			const opacity = material.userData.opacity ?? 1;
			material.transparent = this.visible.through || opacity < 1;
			material.opacity = this.visible.through ? Math.min(0.28, opacity) : opacity;
			material.depthWrite = !material.transparent;
			material.needsUpdate = true;
		}
		if (name === "colours" && this.painted) {
			this.paint(...this.painted);
		}
		if (name === "level") {
			this.showLevel(value);
		}
		this.request();
	}

	showLevel(level) {
		for (const link of this.links) {
			link.tree.clear();
		}
		for (const body of level < 0 ? [] : this.model.bodies) {
			this.place(this.links[body.link].tree, this.shapes.level(body.shape, level, this.materials.tree), body.pose, {});
		}
	}

	robotBox() {
		const box = new Box3();
		this.scene.updateMatrixWorld(true);
		this.links.forEach((link) => link.bodies.children.forEach((body) => box.expandByObject(body)));
		return box.isEmpty() ? new Box3(new Vector3(-0.5, -0.5, 0), new Vector3(0.5, 0.5, 1)) : box;
	}

	/// The robot fills a good part of the picture, seen from a side from which few obstacles hide it.
	frame(view = null) {
		const box = this.robotBox(), center = box.getCenter(new Vector3()), radius = box.getSize(new Vector3()).length() / 2;
		this.floor = Math.min(0, box.min.z);
		if (this.grid) {
			this.grid.position.z = this.floor;
		}
		const narrow = Math.min(1, this.camera.aspect), distance = 1.12 * radius / Math.sin(this.camera.fov * Math.PI / 360) / narrow;
		const direction = view === null ? this.openDirection(center, distance) : directionOf(view.azimuth, view.elevation);
		this.controls.target.copy(center);
		this.camera.position.copy(center).addScaledVector(direction, view?.distance ?? distance);
		this.controls.update();
		this.request();
	}

	openDirection(center, distance) {
		const targets = this.links.filter((link) => link.bodies.children.length > 0).map((link) => new Vector3().setFromMatrixPosition(link.frame.matrixWorld));
		const some = targets.filter((_, i) => i % Math.ceil(targets.length / 4) === 0), ray = new Raycaster();
		let best = null, fewest = Infinity;
		for (let i = 0; i < 12; ++i) {
			// From the front right, alternating to both sides
			const azimuth = -55 + (i % 2 ? 1 : -1) * 30 * Math.ceil(i / 2), direction = directionOf(azimuth, 24);
			const hidden = some.concat([center]).filter((target) => {
				const from = center.clone().addScaledVector(direction, distance), to = target.clone().sub(from);
				ray.far = to.length() - 0.05;
				ray.set(from, to.normalize());
				return ray.intersectObjects(this.obstacles.children, false).length > 0;
			}).length;
			if (hidden < fewest) {
				[best, fewest] = [direction, hidden];
			}
			if (hidden === 0) {
				break;
			}
		}
		return best;
	}

	/// From where the picture is seen: degrees from the x axis, degrees above the horizon, metres.
	side() {
		const offset = this.camera.position.clone().sub(this.controls.target), distance = offset.length();
		return { azimuth: Math.atan2(offset.y, offset.x) * 180 / Math.PI, elevation: Math.asin(offset.z / distance) * 180 / Math.PI, distance };
	}

	/// Turns and zooms by keys: degrees and a factor.
	orbit(azimuth, elevation, zoom = 1) {
		const offset = this.camera.position.clone().sub(this.controls.target);
		const angles = new Spherical().setFromCartesianCoords(offset.x, offset.z, -offset.y);
		angles.theta += azimuth * Math.PI / 180;
		angles.phi = Math.min(Math.PI - 0.05, Math.max(0.05, angles.phi - elevation * Math.PI / 180));
		angles.radius *= zoom;
		const turned = new Vector3().setFromSpherical(angles);
		this.camera.position.copy(this.controls.target).add(new Vector3(turned.x, -turned.z, turned.y));
		this.controls.update();
		this.request();
	}

	/// The link or object under a point of the canvas; null if there is none.
	pick(x, y) {
		const ray = new Raycaster();
		ray.setFromCamera(new Vector2(x, y), this.camera);
		const groups = this.links.filter((link) => link.bodies.visible).map((link) => link.bodies);
		const hits = ray.intersectObjects(this.obstacles.visible && !this.visible.through ? [...groups, this.obstacles] : groups, true);
		return hits.length > 0 ? hits[0].object.userData : null;
	}

	resize() {
		const { clientWidth: width, clientHeight: height } = this.renderer.domElement;
		if (width > 0 && height > 0) {
			this.renderer.setSize(width, height, false);
			this.camera.aspect = width / height;
			this.camera.updateProjectionMatrix();
			this.request();
		}
	}

	request() {
		if (!this.asked) {
			this.asked = true;
			requestAnimationFrame(() => {
				this.asked = false;
				this.draw();
			});
		}
	}

	/// Sets the share of the full resolution.
	sharpness(share) {
		if (share !== this.shown) {
			this.shown = share;
			this.renderer.setPixelRatio(this.full * share);
		}
	}

	/// Where frames take long (no graphics card, large meshes) a movement is drawn coarser; the still picture is drawn in full.
	adapt(now) {
		const time = now - this.drawn, continuous = time < CONTINUOUS && !this.resting && !this.still;
		this.drawn = now;
		this.run = continuous ? this.run + 1 : 0;
		this.pace = continuous ? 0.6 * this.pace + 0.4 * time : 0;
		if (this.run > BEGIN && this.pace > SLOW && this.moving > COARSEST) {
			this.moving = Math.max(COARSEST, 0.7 * this.moving);
			this.pace = 0;
		}
		this.sharpness(this.run > BEGIN ? this.moving : 1);
		clearTimeout(this.rest);
		if (this.shown < 1) {
			this.rest = setTimeout(() => {
				this.resting = true;
				this.draw();
				this.resting = false;
			}, STILL);
		}
	}

	draw() {
		this.adapt(performance.now());
		const shown = this.pair !== null && this.pair !== undefined && this.visible.witness;
		this.witness.visible = shown;
		for (const dot of this.dots) {
			dot.scale.setScalar(0.0045 * dot.position.distanceTo(this.camera.position));
		}
		// From above the left shoulder of the viewer
		this.light.position.copy(this.camera.position).add(new Vector3(-0.5, 0.6, 0).applyQuaternion(this.camera.quaternion)
			.multiplyScalar(this.camera.position.distanceTo(this.controls.target)));
		this.light.target.position.copy(this.controls.target);
		this.renderer.render(this.scene, this.camera);
		++this.frames;
		this.onDraw?.(shown ? this.onScreen(this.pair) : null);
	}

	/// The middle of a pair's points on the canvas, in pixels; null behind the camera.
	onScreen(pair) {
		const middle = new Vector3(...pair.from).add(new Vector3(...pair.to)).multiplyScalar(0.5).project(this.camera);
		const { clientWidth: width, clientHeight: height } = this.renderer.domElement;
		return middle.z < 1 ? { x: (middle.x + 1) / 2 * width, y: (1 - middle.y) / 2 * height } : null;
	}
}

/// Degrees from the x axis, and above the horizon.
function directionOf(azimuth, elevation) {
	const a = azimuth * Math.PI / 180, e = elevation * Math.PI / 180;
	return new Vector3(Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e));
}
