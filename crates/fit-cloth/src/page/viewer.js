// 3D view of sheets and arrows in WebGL, without perspective.
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => a.map((c, i) => c - b[i]);
const unit = (a) => { const length = Math.hypot(...a) || 1; return a.map((c) => c / length); };

const VERTEX = `
  attribute vec3 place, normal, colour;
  uniform mat3 view; uniform vec3 middle; uniform vec3 scale;
  varying vec3 n, c;
  void main() { n = view * normal; c = colour; gl_Position = vec4(view * (place - middle) * scale, 1.0); }`;
// Lines and arrows have no normal and are not shaded.
const FRAGMENT = `
  precision mediump float; uniform float alpha; varying vec3 n, c;
  void main() { float light = length(n) > 0.5 ? 0.45 + 0.55 * abs(normalize(n).z) : 1.0; gl_FragColor = vec4(c * light * alpha, alpha); }`;

class Viewer {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = (this.gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true }));
    if (!gl) return;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    // Keeps the lines of one sheet visible on the surface of the other.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 2);
    this.at = Object.fromEntries(["place", "normal", "colour"].map((name) => [name, gl.getAttribLocation(program, name)]));
    this.uniform = Object.fromEntries(["view", "middle", "scale", "alpha"].map((name) => [name, gl.getUniformLocation(program, name)]));
    this.buffers = { place: gl.createBuffer(), normal: gl.createBuffer(), colour: gl.createBuffer() };
    this.listen();
  }

  listen() {
    const { canvas } = this, fingers = new Map();
    canvas.addEventListener("pointerdown", (e) => { fingers.set(e.pointerId, e); canvas.setPointerCapture(e.pointerId); });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (e) => fingers.delete(e.pointerId));
    canvas.addEventListener("pointermove", (e) => {
      const last = fingers.get(e.pointerId);
      if (!last) return;
      if (fingers.size === 1) {
        this.orbit((last.clientX - e.clientX) * 0.01, (e.clientY - last.clientY) * 0.01);
      } else {
        const other = [...fingers.values()].find((finger) => finger.pointerId !== e.pointerId);
        const apart = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
        this.enlarge(apart(e) / (apart(last) || 1));
      }
      fingers.set(e.pointerId, e);
    });
    canvas.addEventListener("wheel", (e) => { e.preventDefault(); this.enlarge(Math.exp(-e.deltaY * 0.001)); }, { passive: false });
    canvas.addEventListener("dblclick", () => this.startOver());
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  orbit(turn, rise) {
    this.turn += turn;
    this.rise = Math.min(Math.max(this.rise + rise, -1.57), 1.57);
    this.draw();
  }

  enlarge(factor) {
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.2), 40);
    this.draw();
  }

  // Chooses a view that shows all frames of the sequence well.
  startOver() {
    if (!this.sequence) return;
    Object.assign(this, { turn: 0.5, zoom: 1 });
    this.up = unit(this.sequence.up);
    this.rise = 0;
    const [low, high] = this.extent();
    // A flat sheet is viewed from above.
    this.rise = high[1] - low[1] < 0.3 * (high[0] - low[0]) ? 1.0 : 0.35;
    const [from, to] = this.extent();
    const rows = this.view(), middle = from.map((c, i) => (c + to[i]) / 2);
    this.middle = [0, 1, 2].map((i) => rows.reduce((sum, row, k) => sum + row[i] * middle[k], 0));
    this.extents = minus(to, from);
    this.draw();
  }

  // Extent of all frames in view axes: right, up, towards the eye.
  extent() {
    const rows = this.view(), low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const { simulated, measured } of this.sequence.frames) {
      for (const x of measured ? [simulated, measured] : [simulated]) {
        for (let n = 0; n < x.length; n += 3) {
          if (Number.isNaN(x[n])) continue;
          rows.forEach((row, i) => {
            const at = row[0] * x[n] + row[1] * x[n + 1] + row[2] * x[n + 2];
            if (at < low[i]) low[i] = at;
            if (at > high[i]) high[i] = at;
          });
        }
      }
    }
    return [low, high];
  }

  // sheets: { x, colours (per node), side (−1 left half, 1 right half, 0 whole canvas), lines };
  // arrows: { from, to, colour, width, side, alpha }; afresh: reset the view.
  show(sequence, sheets, arrows, afresh) {
    if (!this.gl) return;
    this.sequence = sequence;
    this.batches = sheets.map((sheet) => (sheet.lines ? this.lines(sheet, sequence.mesh) : this.surface(sheet, sequence.mesh)));
    for (const arrow of arrows) this.batches.push(this.arrow(arrow));
    if (afresh || !this.extents) this.startOver(); else this.draw();
  }

  batch(mode, side, alpha, corners) {
    const flat = (i) => new Float32Array(corners.flatMap((corner) => corner[i]));
    return { mode, side, alpha, count: corners.length, place: flat(0), normal: flat(1), colour: flat(2) };
  }

  lines({ x, colours, side }, { lines }) {
    const corners = [];
    const at = (n) => [x[3 * n], x[3 * n + 1], x[3 * n + 2]];
    for (let i = 0; i < lines.length; i += 2) {
      const ends = [lines[i], lines[i + 1]];
      if (ends.some((n) => Number.isNaN(x[3 * n]))) continue;
      for (const n of ends) corners.push([at(n), [0, 0, 0], colours[n]]);
    }
    return this.batch(this.gl.LINES, side, 0.45, corners);
  }

  surface({ x, colours, side }, { triangles }) {
    const normals = new Float32Array(x.length), corners = [], seen = [];
    const at = (n) => [x[3 * n], x[3 * n + 1], x[3 * n + 2]];
    for (let t = 0; t < triangles.length; t += 3) {
      const nodes = [...triangles.subarray(t, t + 3)];
      if (nodes.some((n) => Number.isNaN(x[3 * n]))) continue;
      const [p, q, r] = nodes.map(at), normal = cross(minus(q, p), minus(r, p));
      for (const n of nodes) for (let k = 0; k < 3; k++) normals[3 * n + k] += normal[k];
      seen.push(...nodes);
    }
    for (const n of seen) corners.push([at(n), unit([...normals.subarray(3 * n, 3 * n + 3)]), colours[n]]);
    return this.batch(this.gl.TRIANGLES, side, 1, corners);
  }

  // A four-sided shaft and a four-sided head.
  arrow({ from, to, colour, width, side, alpha }) {
    const corners = [], way = minus(to, from), length = Math.hypot(...way);
    if (length > 0) {
      const along = unit(way), aside = unit(cross(along, Math.abs(along[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0])), across = cross(along, aside);
      const head = Math.min(6 * width, 0.5 * length);
      const ring = (s, r) => [[1, 0], [0, 1], [-1, 0], [0, -1]].map(([c, d]) => from.map((f, i) => f + along[i] * s + r * (c * aside[i] + d * across[i])));
      const [foot, neck, brim] = [ring(0, width), ring(length - head, width), ring(length - head, 2.4 * width)];
      for (let k = 0; k < 4; k++) {
        const l = (k + 1) % 4;
        for (const p of [foot[k], foot[l], neck[l], foot[k], neck[l], neck[k], brim[k], brim[l], to]) corners.push([p, [0, 0, 0], colour]);
      }
    }
    return this.batch(this.gl.TRIANGLES, side, alpha, corners);
  }

  // Rows: right, up, towards the eye.
  view() {
    const { up } = this;
    const level = unit(cross(up, Math.abs(up[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0])), front = cross(level, up);
    const side = level.map((c, i) => c * Math.cos(this.turn) + front[i] * Math.sin(this.turn));
    const towards = side.map((c, i) => c * Math.cos(this.rise) + up[i] * Math.sin(this.rise));
    const right = side.map((_, i) => -level[i] * Math.sin(this.turn) + front[i] * Math.cos(this.turn)).map((c) => -c);
    return [right, cross(towards, right), towards];
  }

  draw() {
    const { gl, canvas } = this;
    if (!gl || !this.batches || !this.extents) return;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((length) => Math.max(1, Math.round(length * ratio)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.scissor(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const rows = this.view();
    gl.uniformMatrix3fv(this.uniform.view, false, [0, 1, 2].flatMap((column) => rows.map((row) => row[column])));
    gl.uniform3fv(this.uniform.middle, this.middle);
    for (const batch of this.batches) {
      const part = batch.side ? width / 2 : width, left = batch.side === 1 ? width / 2 : 0;
      gl.viewport(left, 0, part, height);
      gl.scissor(left, 0, part, height);
      // The sheet fills three quarters, to leave room for arrows.
      const pixels = 0.78 * this.zoom * Math.min(part / this.extents[0], height / (this.extents[1] || this.extents[0]));
      const depth = 0.1 / (Math.hypot(...this.extents) * Math.max(this.zoom, 1));
      gl.uniform3f(this.uniform.scale, (2 * pixels) / part, (2 * pixels) / height, -depth);
      gl.uniform1f(this.uniform.alpha, batch.alpha);
      for (const name of ["place", "normal", "colour"]) {
        gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
        gl.bufferData(gl.ARRAY_BUFFER, batch[name], gl.DYNAMIC_DRAW);
        gl.enableVertexAttribArray(this.at[name]);
        gl.vertexAttribPointer(this.at[name], 3, gl.FLOAT, false, 0, 0);
      }
      gl.drawArrays(batch.mode, 0, batch.count);
    }
  }
}
