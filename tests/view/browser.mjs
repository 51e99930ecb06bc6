// SPDX-License-Identifier: BSD-3-Clause
// A headless Chromium, driven by the DevTools protocol through a pipe: no package and no port is needed.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const PATIENCE = 120000; // milliseconds for one answer

/// Arguments for pictures by software: the same on every machine.
const ARGUMENTS = ["--headless=new", "--remote-debugging-pipe", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars", "--no-first-run",
	"--disable-extensions", "--disable-background-networking", "--disable-component-update", "--force-color-profile=srgb", "--disable-dev-shm-usage"];

export class Browser {
	/// @param more arguments beside those that all pages get
	constructor(more = [], program = process.env.LEEWAY_BROWSER || "chromium") {
		this.profile = mkdtempSync(join(tmpdir(), "leeway-browser-"));
		const root = process.getuid?.() === 0 ? ["--no-sandbox"] : [];
		this.process = spawn(program, [...ARGUMENTS, ...more, ...root, `--user-data-dir=${this.profile}`], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
		this.process.on("error", (error) => this.fail(new Error(`${program} does not start: ${error.message}`)));
		this.process.on("exit", (code) => this.fail(new Error(`${program} ended with status ${code}`)));
		this.process.stdio[3].on("error", () => {});
		this.waiting = new Map();
		this.listeners = [];
		this.next = 1;
		let rest = "";
		this.process.stdio[4].on("data", (chunk) => {
			const parts = (rest + chunk).split("\0");
			rest = parts.pop();
			parts.forEach((part) => this.receive(JSON.parse(part)));
		});
	}

	fail(error) {
		this.waiting.forEach(({ reject }) => reject(error));
		this.waiting.clear();
	}

	receive(message) {
		const waiting = this.waiting.get(message.id);
		if (waiting !== undefined) {
			this.waiting.delete(message.id);
			clearTimeout(waiting.timer);
			(message.error ? waiting.reject(new Error(`${waiting.method}: ${message.error.message}`)) : waiting.resolve(message.result));
		} else {
			this.listeners.forEach((listener) => listener(message));
		}
	}

	send(method, params = {}, sessionId = undefined) {
		return new Promise((resolve, reject) => {
			const id = this.next++, timer = setTimeout(() => reject(new Error(`${method}: no answer`)), PATIENCE);
			this.waiting.set(id, { resolve, reject, method, timer });
			this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
		});
	}

	/// Opens a file in a new tab of this size.
	async open(file, { width = 1280, height = 800, touch = false, hash = "" } = {}) {
		const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
		const { sessionId } = await this.send("Target.attachToTarget", { targetId, flatten: true });
		const tab = new Tab(this, sessionId, targetId);
		await tab.prepare(width, height, touch);
		tab.begun = performance.now();
		await tab.send("Page.navigate", { url: pathToFileURL(file).href + hash });
		return tab;
	}

	async close() {
		this.process.removeAllListeners("exit");
		const ended = new Promise((resolve) => { this.process.on("exit", resolve); });
		this.send("Browser.close").catch(() => {});
		const timer = setTimeout(() => this.process.kill("SIGKILL"), 5000);
		await ended;
		clearTimeout(timer);
		rmSync(this.profile, { recursive: true, force: true, maxRetries: 5 });
	}
}

export class Tab {
	constructor(browser, session, target) {
		Object.assign(this, { browser, session, target, errors: [], requests: [] });
		browser.listeners.push((message) => message.sessionId === session && this.hear(message));
	}

	send(method, params = {}) {
		return this.browser.send(method, params, this.session);
	}

	hear({ method, params }) {
		if (method === "Runtime.exceptionThrown") {
			this.errors.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
		} else if (method === "Log.entryAdded" && ["error", "warning"].includes(params.entry.level)) {
			this.errors.push(params.entry.text);
		} else if (method === "Runtime.consoleAPICalled" && ["error", "warning", "assert"].includes(params.type)) {
			this.errors.push(params.args.map((argument) => argument.value ?? argument.description).join(" "));
		} else if (method === "Network.requestWillBeSent") {
			this.requests.push(params.request.url);
		}
	}

	async prepare(width, height, touch) {
		for (const domain of ["Page", "Runtime", "Log", "Network"]) {
			await this.send(`${domain}.enable`);
		}
		await this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: touch });
		await this.send("Emulation.setTouchEmulationEnabled", { enabled: touch });
	}

	/// The value of an expression, which may be a promise.
	async value(expression) {
		const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true, userGesture: true });
		if (exceptionDetails) {
			throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
		}
		return result.value;
	}

	/// Waits until an expression is true.
	async until(expression, what = expression) {
		const end = Date.now() + PATIENCE;
		while (!(await this.value(expression).catch(() => false))) {
			if (Date.now() > end) {
				throw new Error(`never: ${what}; errors: ${this.errors.join("; ")}`);
			}
			await new Promise((resolve) => { setTimeout(resolve, 20); });
		}
	}

	/// Waits for the page and its engine: "live" or "stored".
	async ready() {
		await this.until("document.documentElement.dataset.ready !== undefined", "the page is ready");
		return this.value("document.documentElement.dataset.ready");
	}

	/// PNG as a buffer.
	async picture() {
		await this.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
		return Buffer.from((await this.send("Page.captureScreenshot", { format: "png" })).data, "base64");
	}

	async key(key) {
		const text = key.length === 1 ? key : undefined, code = key === " " ? "Space" : key;
		await this.send("Input.dispatchKeyEvent", { type: "keyDown", key, code, text });
		await this.send("Input.dispatchKeyEvent", { type: "keyUp", key, code });
	}

	async click(x, y) {
		for (const type of ["mousePressed", "mouseReleased"]) {
			await this.send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: type === "mousePressed" ? 1 : 0, clickCount: 1 });
		}
	}

	async drag(from_x, from_y, to_x, to_y) {
		for (const [type, x, y] of [["mousePressed", from_x, from_y], ["mouseMoved", (from_x + to_x) / 2, (from_y + to_y) / 2], ["mouseMoved", to_x, to_y], ["mouseReleased", to_x, to_y]]) {
			await this.send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 });
		}
	}

	async tap(x, y) {
		await this.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [{ x, y }] });
		await this.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
	}

	/// The middle of an element, scrolled into view.
	async middle(selector) {
		return this.value(`(() => { const e = document.querySelector(${JSON.stringify(selector)}); e.scrollIntoView({ block: "center" });
			const b = e.getBoundingClientRect(); return { x: b.x + b.width / 2, y: b.y + b.height / 2 }; })()`);
	}

	async close() {
		await this.browser.send("Target.closeTarget", { targetId: this.target });
	}
}
