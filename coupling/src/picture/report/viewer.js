'use strict';
const meta = JSON.parse(document.getElementById('meta').textContent);
const $ = (id) => document.getElementById(id);

// ---------- numbers out of the page ----------

async function bytesOf(id) {
  const text = $(id).textContent;
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Frames of codes, component after component, and of speeds; the inverse of the packing. */
function unpacked(raw, n, components, hasSpeeds) {
  const size = n * components * 2 + (hasSpeeds ? n : 0);
  const frames = [];
  for (let start = 0; start + size <= raw.length && size > 0; start += size) {
    const before = frames[frames.length - 1];
    const codes = new Uint16Array(n * components);
    for (let c = 0; c < components; c++) {
      const low = start + 2 * c * n, high = low + n, at = c * n;
      for (let i = 0; i < n; i++) {
        const z = raw[low + i] | (raw[high + i] << 8);
        const reference = before ? before.codes[at + i] : (i > 0 ? codes[at + i - 1] : 0);
        codes[at + i] = reference + ((z >> 1) ^ -(z & 1));
      }
    }
    let speeds = null;
    if (hasSpeeds) {
      speeds = new Uint8Array(n);
      const from = start + 2 * components * n;
      for (let i = 0; i < n; i++) {
        const reference = before ? before.speeds[i] : (i > 0 ? speeds[i - 1] : 0);
        speeds[i] = reference + raw[from + i];
      }
    }
    frames.push({ codes, speeds });
  }
  return frames;
}

function checksum(frames) {
  let sum = 0;
  for (const { codes } of frames) for (const code of codes) sum = (Math.imul(sum, 31) + code) >>> 0;
  return sum;
}

/** The frame at or before a time, the one after it, and the share of the way between them. */
function between(times, t) {
  let a = 0, b = times.length - 1;
  while (a < b) {
    const middle = (a + b + 1) >> 1;
    if (times[middle] <= t) a = middle; else b = middle - 1;
  }
  const next = Math.min(a + 1, times.length - 1);
  const width = times[next] - times[a];
  return [a, next, width > 0 ? Math.min(Math.max((t - times[a]) / width, 0), 1) : 0];
}

// ---------- geometry ----------

const sub = (a, b) => a.map((x, k) => x - b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => { const l = Math.hypot(...a) || 1; return a.map((x) => x / l); };
function product(a, b) {
  const m = new Float32Array(16);
  for (let c = 0; c < 4; c++) for (let r = 0; r < 4; r++) {
    let s = 0;
    for (let k = 0; k < 4; k++) s += a[4 * k + r] * b[4 * c + k];
    m[4 * c + r] = s;
  }
  return m;
}
function lookAt(eye, target, up) {
  const f = unit(sub(target, eye)), s = unit(cross(f, up)), u = cross(s, f);
  return new Float32Array([s[0], u[0], -f[0], 0, s[1], u[1], -f[1], 0, s[2], u[2], -f[2], 0, -dot(s, eye), -dot(u, eye), dot(f, eye), 1]);
}
function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan(angle / 2);
  return new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0]);
}
const parallel = (w, h, near, far) =>
  new Float32Array([1 / w, 0, 0, 0, 0, 1 / h, 0, 0, 0, 0, 2 / (near - far), 0, 0, 0, (far + near) / (near - far), 1]);

// ---------- what is drawn ----------

const colorFunctions = `
uniform vec3 stops[9]; uniform vec3 low[4]; uniform vec3 high[4];
vec3 ofSpeed(float s) { s = clamp(s, 0., 1.) * 8.; int i = int(min(s, 7.)); return mix(stops[i], stops[i + 1], s - float(i)); }
vec3 ofRise(float s) { float t = min(abs(s), 1.) * 3.; int i = int(min(t, 2.)); return s < 0. ? mix(low[i], low[i + 1], t - float(i)) : mix(high[i], high[i + 1], t - float(i)); }`;
const light = `
vec3 lit(vec3 color, vec3 n, vec3 toEye) { if (dot(n, toEye) < 0.) n = -n; float d = max(dot(n, normalize(vec3(-.4, -.55, .75))), 0.); return color * (.58 + .47 * d); }`;
const sources = {
  points: [`#version 300 es
    in float x0, y0, z0, s0, x1, y1, z1, s1;
    uniform mat4 camera; uniform vec3 lo, step_; uniform float absent, share, size; uniform bool isPlane; uniform float largest;
    flat out vec3 own; flat out float side; ${colorFunctions}
    void main() {
      vec3 a = vec3(x0, y0, z0), b = vec3(x1, y1, z1);
      bool isA = x0 < absent, isB = x1 < absent;
      if (!isA && !isB) { gl_Position = vec4(2., 2., 2., 1.); gl_PointSize = 1.; own = vec3(0.); side = 1.; return; }
      vec3 code = !isA ? b : !isB ? a : mix(a, b, share);
      // a particle that crossed a periodic side did not fly through the domain
      if (isA && isB && any(greaterThan(abs(a - b), vec3(absent * .5)))) code = share < .5 ? a : b;
      vec3 x = lo + code * step_;
      own = ofSpeed(mix(s0, s1, share) / 255.);
      gl_Position = camera * vec4(x, 1.);
      gl_PointSize = side = max(size / gl_Position.w, 1.5);
    }`, `#version 300 es
    precision highp float; flat in vec3 own; flat in float side; out vec4 color;
    // between small discs the background would show as a pattern
    void main() { vec2 p = gl_PointCoord * 2. - 1.; float r = side < 7. ? 0. : dot(p, p); if (1. < r) discard; color = vec4(own * (1. - .28 * r), 1.); }`],
  surface: [`#version 300 es
    in float z0, s0, z1, s1;
    uniform mat4 camera; uniform vec2 corner; uniform float cell, lo, step_, absent, share; uniform int width;
    uniform float rest, swing; uniform bool isBySpeed;
    out vec3 place, own; out float wet; ${colorFunctions}
    void main() {
      bool isA = z0 < absent, isB = z1 < absent;
      float code = !isA ? z1 : !isB ? z0 : mix(z0, z1, share);
      wet = (isA && isB) || (isA && share < .5) || (isB && .5 <= share) ? 1. : 0.;
      vec2 at = corner + (vec2(float(gl_VertexID % width), float(gl_VertexID / width)) + .5) * cell;
      place = vec3(at, lo + code * step_);
      own = isBySpeed ? ofSpeed(mix(s0, s1, share) / 255.) : ofRise((place.z - rest) / swing);
      gl_Position = camera * vec4(place, 1.);
    }`, `#version 300 es
    precision highp float; in vec3 place, own; in float wet; out vec4 color; uniform vec3 eye; ${light}
    void main() {
      if (wet < .999) discard;
      color = vec4(lit(own, normalize(cross(dFdx(place), dFdy(place))), eye - place), 1.);
    }`],
  solids: [`#version 300 es
    in float x, y, z, body;
    uniform mat4 camera; uniform float lo, step_, share; uniform bool isMoving; uniform sampler2D poses;
    out vec3 place; flat out float number;
    vec3 turned(vec4 q, vec3 v) { return v + 2. * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
    void main() {
      vec3 local = vec3(x, y, z) * step_ + lo; number = body; place = local;
      if (isMoving) {
        int b = int(body);
        vec4 a = texelFetch(poses, ivec2(b, 0), 0), qa = texelFetch(poses, ivec2(b, 1), 0);
        vec4 c = texelFetch(poses, ivec2(b, 2), 0), qc = texelFetch(poses, ivec2(b, 3), 0);
        if (a.w < .5 && c.w < .5) { gl_Position = vec4(2., 2., 2., 1.); return; }
        float s = a.w < .5 ? 1. : c.w < .5 ? 0. : share;
        place = mix(a.xyz, c.xyz, s) + turned(normalize(mix(qa, qc, s)), local);
      }
      gl_Position = camera * vec4(place, 1.);
    }`, `#version 300 es
    precision highp float; in vec3 place; flat in float number; out vec4 color;
    uniform bool isMoving, isGlassPass, isOpaque; uniform vec3 eye, towards, low, high; uniform bool isParallel; uniform vec3 land[5], bed; uniform vec2 relief; ${light}
    vec3 tint(float z) { float s = (z - relief.x) / (relief.y - relief.x) * 4.; return s < 0. ? bed : s < 1. ? mix(land[0], land[1], s) : s < 2. ? mix(land[1], land[2], s - 1.) : s < 3. ? mix(land[2], land[3], s - 2.) : mix(land[3], land[4], min(s - 3., 1.)); }
    void main() {
      vec3 n = normalize(cross(dFdx(place), dFdy(place)));
      vec3 toEye = isParallel ? -towards : normalize(eye - place);
      if (dot(n, toEye) < 0.) n = -n;
      bool isTerrain = !isMoving && .5 < number;
      bool isWall = !isMoving && !isTerrain && !isOpaque;
      // of walls only what faces the viewer is seen, and before the water only as glass
      if (isWall && !gl_FrontFacing) discard;
      bool isBefore = any(lessThan(mix(high - place, place - low, lessThan(toEye, vec3(0.))), (high - low) * .002));
      bool isGlass = isWall && n.z < .3 && isBefore;
      if (isGlass != isGlassPass) discard;
      float shade = fract(number * .618034) - .5;
      vec3 own = isMoving ? vec3(.60, .43, .31) + .10 * shade : isTerrain ? tint(place.z) : vec3(.78, .78, .76);
      color = vec4(lit(own, n, toEye), isGlass ? .09 : 1.);
    }`],
};

function program(gl, [vertex, fragment]) {
  const p = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(p, shader);
  }
  gl.linkProgram(p);
  if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(p));
  const places = {};
  return {
    p,
    at: (name) => (name in places ? places[name] : (places[name] = gl.getUniformLocation(p, name))),
    attribute: (name) => gl.getAttribLocation(p, name),
  };
}

function isDrawnBySoftware() {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl && gl.getExtension('WEBGL_debug_renderer_info');
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  const lose = gl && gl.getExtension('WEBGL_lose_context');
  if (lose) lose.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

class Scene {
  constructor(canvas, data) {
    // without a graphics processor smooth edges cost more than they are worth
    const gl = canvas.getContext('webgl2', { antialias: !isDrawnBySoftware() });
    if (!gl) throw new Error('this browser has no WebGL 2');
    Object.assign(this, { canvas, gl, data, view: meta.isThin ? 'section' : 'orbit', bySpeed: false, isCoarse: false });
    this.programs = Object.fromEntries(Object.entries(sources).map(([name, text]) => [name, program(gl, text)]));
    gl.enable(gl.DEPTH_TEST);
    const [lo, hi] = meta.bounds;
    this.middle = lo.map((x, k) => 0.5 * (x + hi[k]));
    this.extent = lo.map((x, k) => Math.max(hi[k] - x, 1e-6));
    this.radius = 0.5 * Math.hypot(...this.extent);
    this.reset();
    if (data.fixed) this.fixed = this.mesh(data.fixed, meta.fixed);
    if (data.shapes) {
      this.shapes = this.mesh(data.shapes, meta.blocks.mesh);
      this.poses = gl.createTexture();
    }
    if (data.water) this.prepareWater();
  }

  reset() {
    this.turn = -1.15; this.tilt = 0.42; this.zoom = 1; this.target = [...this.middle];
  }

  buffer(values, kind) {
    const { gl } = this, b = gl.createBuffer();
    gl.bindBuffer(kind || gl.ARRAY_BUFFER, b);
    gl.bufferData(kind || gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    return b;
  }

  mesh(raw, info) {
    const { gl } = this, n = info.corners;
    const shorts = new Uint16Array(raw.buffer.slice(0, 8 * n));
    const corners = new Uint32Array(raw.buffer.slice(8 * n, 8 * n + 12 * info.triangles));
    const vao = gl.createVertexArray(), p = this.programs.solids;
    gl.bindVertexArray(vao);
    this.buffer(shorts);
    ['x', 'y', 'z', 'body'].forEach((name, k) => this.attribute(p, name, gl.UNSIGNED_SHORT, 2 * k * n));
    this.buffer(corners, gl.ELEMENT_ARRAY_BUFFER);
    gl.bindVertexArray(null);
    return { vao, count: 3 * info.triangles, info };
  }

  attribute(p, name, kind, offset) {
    const { gl } = this, at = p.attribute(name);
    if (at < 0) return;
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 1, kind, false, 0, offset || 0);
  }

  prepareWater() {
    const { gl } = this, w = meta.water;
    this.waterVao = gl.createVertexArray();
    this.slots = [0, 1].map(() => ({ codes: gl.createBuffer(), speeds: gl.createBuffer(), frame: -1 }));
    if (w.kind !== 'surface') return;
    this.triangles = [1, 2].map((every) => this.trianglesOf(w.size, every));
  }

  /** Triangles of the surface between every first or every second row and column. */
  trianglesOf([nx, ny], every) {
    const { gl } = this, columns = Math.floor((nx - 1) / every), rows = Math.floor((ny - 1) / every);
    const corners = new Uint32Array(6 * columns * rows), up = nx * every;
    let k = 0;
    for (let j = 0; j < rows; j++) for (let i = 0; i < columns; i++) {
      const a = every * (i + nx * j);
      corners.set([a, a + every, a + up, a + every, a + every + up, a + up], k);
      k += 6;
    }
    gl.bindVertexArray(null);
    return { buffer: this.buffer(corners, gl.ELEMENT_ARRAY_BUFFER), count: corners.length };
  }

  loadFrame(slot, number) {
    if (slot.frame === number) return;
    const { gl } = this, frame = this.data.water[number];
    gl.bindBuffer(gl.ARRAY_BUFFER, slot.codes);
    gl.bufferData(gl.ARRAY_BUFFER, frame.codes, gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, slot.speeds);
    gl.bufferData(gl.ARRAY_BUFFER, frame.speeds, gl.DYNAMIC_DRAW);
    slot.frame = number;
  }

  camera(aspect) {
    const [ex, ey, ez] = this.extent, far = 20 * this.radius;
    const flat = (eye, up, w, h) => {
      const fit = 1.06 * Math.max(0.5 * w / aspect, 0.5 * h) / this.zoom;
      const towards = unit(sub(this.target, eye));
      this.isParallel = true; this.eye = eye; this.towards = towards; this.halfHeight = fit;
      return product(parallel(fit * aspect, fit, 0, far), lookAt(eye, this.target, up));
    };
    const away = (direction) => this.target.map((x, k) => x + 0.5 * far * direction[k]);
    if (this.view === 'section') return flat(away([0, -1, 0]), [0, 0, 1], ex, ez);
    if (this.view === 'top') return flat(away([0, 0, 1]), [0, 1, 0], ex, ey);
    const c = Math.cos(this.tilt), direction = [c * Math.cos(this.turn), c * Math.sin(this.turn), Math.sin(this.tilt)];
    const angle = 0.6, distance = this.radius / Math.sin(angle / 2) / Math.min(1, aspect) / this.zoom * 0.62;
    const eye = this.target.map((x, k) => x + distance * direction[k]);
    this.isParallel = false; this.eye = eye; this.towards = unit(sub(this.target, eye)); this.halfHeight = Math.tan(angle / 2);
    return product(perspective(angle, aspect, distance * 0.02, distance + 4 * this.radius), lookAt(eye, this.target, [0, 0, 1]));
  }

  draw(t) {
    const { gl, canvas } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...meta.colors.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const camera = this.camera(canvas.width / canvas.height);
    if (this.fixed) this.drawSolids(camera, this.fixed, false, false);
    if (this.shapes) { this.loadPoses(t); this.drawSolids(camera, this.shapes, true, false); }
    if (this.data.water) this.drawWater(camera, t);
    if (this.fixed && this.fixed.info.walls && !meta.isThin) {
      gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA); gl.depthMask(false);
      this.drawSolids(camera, this.fixed, false, true);
      gl.disable(gl.BLEND); gl.depthMask(true);
    }
  }

  drawSolids(camera, mesh, isMoving, isGlassPass) {
    const { gl } = this, p = this.programs.solids;
    gl.useProgram(p.p);
    gl.uniformMatrix4fv(p.at('camera'), false, camera);
    gl.uniform1f(p.at('lo'), mesh.info.lo); gl.uniform1f(p.at('step_'), mesh.info.step);
    gl.uniform1f(p.at('share'), this.poseShare || 0);
    gl.uniform1i(p.at('isMoving'), isMoving ? 1 : 0); gl.uniform1i(p.at('isGlassPass'), isGlassPass ? 1 : 0);
    gl.uniform1i(p.at('isOpaque'), meta.isThin ? 1 : 0); gl.uniform1i(p.at('isParallel'), this.isParallel ? 1 : 0);
    gl.uniform3fv(p.at('eye'), this.eye); gl.uniform3fv(p.at('towards'), this.towards);
    gl.uniform3fv(p.at('low'), meta.bounds[0]); gl.uniform3fv(p.at('high'), meta.bounds[1]);
    gl.uniform3fv(p.at('land'), meta.colors.land.flat()); gl.uniform3fv(p.at('bed'), meta.colors.bed); gl.uniform2fv(p.at('relief'), meta.relief || [0, 1]);
    if (isMoving) { gl.activeTexture(gl.TEXTURE0); gl.bindTexture(gl.TEXTURE_2D, this.poses); gl.uniform1i(p.at('poses'), 0); }
    gl.bindVertexArray(mesh.vao);
    gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
    gl.bindVertexArray(null);
  }

  loadPoses(t) {
    const { gl } = this, b = meta.blocks, n = b.ids.length;
    const [first, second, share] = between(b.times, t);
    this.poseShare = share;
    const texels = new Float32Array(n * 4 * 4);
    [first, second].forEach((number, row) => {
      const { codes } = this.data.poses[number];
      for (let i = 0; i < n; i++) {
        const at = 4 * (2 * row * n + i), isHere = codes[i] < 65535;
        for (let k = 0; k < 3; k++) texels[at + k] = b.lo[k] + codes[k * n + i] * b.step[k];
        texels[at + 3] = isHere ? 1 : 0;
        for (let k = 0; k < 4; k++) texels[at + 4 * n + k] = -1 + codes[(3 + k) * n + i] * 2 / 65534;
      }
    });
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.poses);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, n, 4, 0, gl.RGBA, gl.FLOAT, texels);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  }

  drawWater(camera, t) {
    const { gl } = this, w = meta.water, n = w.items;
    const [first, second, share] = between(w.times, t);
    // what was second is now first: only one of the two is new
    if (this.slots[1].frame === first) this.slots.reverse();
    this.loadFrame(this.slots[0], first);
    this.loadFrame(this.slots[1], second);
    const p = this.programs[w.kind === 'surface' ? 'surface' : 'points'];
    gl.useProgram(p.p);
    gl.bindVertexArray(this.waterVao);
    this.slots.forEach((slot, k) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, slot.codes);
      w.axes.forEach((axis, c) => this.attribute(p, axis + k, gl.UNSIGNED_SHORT, 2 * c * n));
      gl.bindBuffer(gl.ARRAY_BUFFER, slot.speeds);
      this.attribute(p, 's' + k, gl.UNSIGNED_BYTE, 0);
    });
    gl.uniformMatrix4fv(p.at('camera'), false, camera);
    gl.uniform1f(p.at('absent'), w.absent); gl.uniform1f(p.at('share'), share);
    for (const [name, colors] of [['stops', 'speed'], ['low', 'trough'], ['high', 'crest']]) {
      if (p.at(name)) gl.uniform3fv(p.at(name), meta.colors[colors].flat());
    }
    if (w.kind === 'surface') {
      gl.uniform2fv(p.at('corner'), w.corner); gl.uniform1f(p.at('cell'), w.cell); gl.uniform1i(p.at('width'), w.size[0]);
      gl.uniform1f(p.at('lo'), w.lo[0]); gl.uniform1f(p.at('step_'), w.step[0]);
      gl.uniform1f(p.at('rest'), w.rest); gl.uniform1f(p.at('swing'), w.swing);
      gl.uniform1i(p.at('isBySpeed'), this.bySpeed ? 1 : 0); gl.uniform3fv(p.at('eye'), this.eye);
      const { buffer, count } = this.triangles[this.isCoarse ? 1 : 0];
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
    } else {
      const three = (values, missing) => w.axes.length === 3 ? values : [values[0], missing, values[1]];
      gl.uniform3fv(p.at('lo'), three(w.lo, this.middle[1])); gl.uniform3fv(p.at('step_'), three(w.step, 0));
      const pixels = this.canvas.height / (2 * this.halfHeight);
      gl.uniform1f(p.at('size'), (meta.isThin ? 1.3 : 1.1) * w.spacing * pixels);
      gl.drawArrays(gl.POINTS, 0, n);
    }
    gl.bindVertexArray(null);
  }
}

// ---------- gauges ----------

const label = (x) => (x === null || x === undefined || Number.isNaN(x) ? '' : Math.abs(x) >= 1e5 || (x !== 0 && Math.abs(x) < 1e-3) ? x.toExponential(3) : String(+x.toPrecision(4)));

const escaped = (text) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

function chart(gauge) {
  const W = Math.min(Math.max($('chart').clientWidth || 900, 260), 1120), H = W < 560 ? 200 : 230, L = 58, R = 14, T = 22, B = 36;
  const known = [...gauge.v, ...(gauge.theory || [])].filter((v) => v !== null);
  if (!known.length) return { svg: '<p>dry</p>', at: () => 0 };
  let lo = Math.min(...known), hi = Math.max(...known);
  const pad = 0.06 * (hi - lo) || Math.abs(hi) * 0.1 || 1;
  lo -= pad; hi += pad;
  const end = meta.duration || 1;
  const X = (t) => L + (W - L - R) * t / end, Y = (v) => T + (H - T - B) * (hi - v) / (hi - lo);
  const path = (values) => {
    let text = '', isDown = false;
    gauge.t.forEach((t, k) => {
      const v = values[k];
      text += v === null ? '' : `${isDown ? 'L' : 'M'}${X(t).toFixed(1)},${Y(v).toFixed(1)}`;
      isDown = v !== null;
    });
    return text;
  };
  const nice = (span, n) => { const p = 10 ** Math.floor(Math.log10(span / n)); return p * ([1, 2, 5, 10].find((m) => m * p >= span / n)); };
  let grid = '';
  for (let d = nice(hi - lo, 5), v = Math.ceil(lo / d) * d; v <= hi; v += d) grid += `<path d="M${L},${Y(v)}H${W - R}" class="grid"/><text x="${L - 6}" y="${Y(v) + 4}" text-anchor="end">${label(Math.abs(v) < d * 1e-6 ? 0 : v)}</text>`;
  for (let d = nice(end, W < 560 ? 5 : 10), t = 0; t <= end * 1.0001; t += d) grid += `<path d="M${X(t)},${T}V${H - B}" class="grid"/><text x="${X(t)}" y="${H - B + 16}" text-anchor="middle">${label(t)}</text>`;
  const svg = `<svg viewBox="0 0 ${W} ${H}" role="img" aria-label="${escaped(gauge.name)} over time">${grid}<text x="${W - R}" y="${H - 4}" text-anchor="end">time, s</text><text x="${L}" y="${T - 8}">${escaped(gauge.name)}, ${escaped(gauge.unit)}${gauge.theory ? '; dotted: theory' : ''}</text>${gauge.theory ? `<path d="${path(gauge.theory)}" class="theory"/>` : ''}<path d="${path(gauge.v)}" class="curve"/><path id="now" d="" class="now"/></svg>`;
  return { svg, at: (t) => `M${X(t).toFixed(1)},${T}V${H - B}` };
}

// ---------- the page ----------

async function main() {
  const data = {};
  if (meta.water) data.water = unpacked(await bytesOf('water'), meta.water.items, meta.water.axes.length, true);
  if (meta.fixed) data.fixed = await bytesOf('fixed');
  if (meta.blocks) {
    data.shapes = await bytesOf('shapes');
    data.poses = unpacked(await bytesOf('poses'), meta.blocks.ids.length, 7, false);
  }
  const canvas = $('canvas'), slider = $('time');
  const scene = new Scene(canvas, data);
  let now = 0, isPlaying = false, last = 0;
  // a slow computer plays with fewer pixels and a coarser surface, and shows all of them when it stops
  const qualities = [[1, false], [0.75, false], [0.75, true], [0.5, true]];
  let ease = 0, slow = 0;
  const watch = (passed) => {
    slow = 0.85 * slow + 0.15 * Math.min(passed, 250);
    if (slow < 38 || ease + 1 === qualities.length) return;
    ease += 1; slow = 0;
    resize();
  };

  let curve = null;
  const showGauge = (k) => {
    curve = chart(meta.gauges[k]);
    $('chart').innerHTML = curve.svg;
    moveLine();
  };
  const moveLine = () => { const line = $('now'); if (line && curve) line.setAttribute('d', curve.at(now)); };
  const draw = () => {
    scene.draw(now);
    slider.value = now;
    $('clock').textContent = `${now.toFixed(meta.duration < 100 ? 2 : 1)} s`;
    slider.setAttribute('aria-valuetext', `${now.toFixed(2)} seconds`);
    moveLine();
  };
  const resize = () => {
    // a flume is long and low
    const [ex, , ez] = scene.extent;
    if (meta.isThin) canvas.style.height = `${Math.round(Math.min(Math.max(canvas.clientWidth * ez / ex * 1.35, 220), 0.58 * Math.max(window.innerHeight, 400)))}px`;
    if (!canvas.clientWidth) return; // on paper
    const [share, isCoarse] = qualities[isPlaying ? ease : 0];
    const ratio = share * Math.min(window.devicePixelRatio || 1, 2);
    scene.isCoarse = isCoarse;
    canvas.width = Math.round(canvas.clientWidth * ratio);
    canvas.height = Math.round(canvas.clientHeight * ratio);
    draw();
  };
  const go = (t) => { now = Math.min(Math.max(t, 0), meta.duration); draw(); };
  const play = (is) => {
    isPlaying = is;
    $('play').textContent = is ? '❚❚' : '▶';
    $('play').setAttribute('aria-label', is ? 'pause' : 'play');
    if (is && now >= meta.duration) now = 0;
    if (0 < ease) resize();
    if (is) { last = performance.now(); slow = 0; requestAnimationFrame(tick); }
  };
  const tick = (at) => {
    if (!isPlaying) return;
    watch(at - last);
    now += Math.max(at - last, 0) / 1000 * Number($('pace').value); last = at;
    if (now >= meta.duration) { now = meta.duration; play(false); }
    draw();
    requestAnimationFrame(tick);
  };
  const setView = (view) => {
    scene.view = view; scene.reset();
    for (const name of ['orbit', 'top', 'section']) $(name).setAttribute('aria-pressed', name === view);
    draw();
  };

  slider.max = meta.duration; slider.step = meta.duration / 1000;
  slider.addEventListener('input', () => { play(false); go(Number(slider.value)); });
  $('play').addEventListener('click', () => play(!isPlaying));
  for (const name of ['orbit', 'top', 'section']) $(name).addEventListener('click', () => setView(name));
  if (meta.water && meta.water.kind === 'surface') {
    $('colors').hidden = false;
    $('color').addEventListener('change', () => { scene.bySpeed = $('color').value === 'speed'; legend(); draw(); });
  }
  const legend = () => {
    if (!meta.water) { $('legend').hidden = true; return; }
    const bySpeed = meta.water.kind !== 'surface' || scene.bySpeed;
    const css = (colors) => colors.map((c) => `rgb(${c.map((x) => Math.round(255 * x))})`);
    const stops = bySpeed ? css(meta.colors.speed) : [...css(meta.colors.trough).reverse(), ...css(meta.colors.crest).slice(1)];
    $('ramp').style.background = `linear-gradient(90deg, ${stops})`;
    const w = meta.water;
    $('from').textContent = bySpeed ? '0' : `−${label(w.swing)}`;
    $('to').textContent = bySpeed ? `${label(w.fastest)} m/s` : `+${label(w.swing)} m about rest`;
  };
  legend();

  const steps = meta.water ? meta.water.times : meta.blocks.times;
  document.addEventListener('keydown', (event) => {
    if (event.target.matches('select, input') && event.key !== ' ') return;
    const [frame] = between(steps, now + 1e-9);
    const keys = {
      ' ': () => play(!isPlaying), ArrowRight: () => go(steps[Math.min(frame + 1, steps.length - 1)]),
      ArrowLeft: () => go(steps[Math.max(frame - 1, 0)]), Home: () => go(0), End: () => go(meta.duration),
      1: () => setView('orbit'), 2: () => setView('top'), 3: () => setView('section'), '+': () => { scene.zoom *= 1.2; draw(); }, '-': () => { scene.zoom /= 1.2; draw(); },
    };
    if (keys[event.key] && !(event.key === ' ' && event.target.matches('button'))) { event.preventDefault(); keys[event.key](); }
  });

  let drag = null;
  const touches = new Map();
  canvas.addEventListener('pointerdown', (e) => { canvas.setPointerCapture(e.pointerId); touches.set(e.pointerId, [e.clientX, e.clientY]); drag = [e.clientX, e.clientY]; });
  const release = (e) => { touches.delete(e.pointerId); drag = null; };
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('pointermove', (e) => {
    if (!touches.has(e.pointerId)) return;
    const before = touches.get(e.pointerId);
    if (touches.size === 2) {
      const [other] = [...touches].filter(([id]) => id !== e.pointerId).map(([, x]) => x);
      const spread = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      scene.zoom *= spread([e.clientX, e.clientY]) / spread(before);
    } else if (drag) {
      const dx = e.clientX - before[0], dy = e.clientY - before[1];
      if (scene.view === 'orbit' && !e.shiftKey) {
        scene.turn -= dx * 0.008; scene.tilt = Math.min(Math.max(scene.tilt + dy * 0.006, -0.2), 1.5);
      } else {
        const f = scene.towards, s = unit(cross(f, scene.view === 'top' ? [0, 1, 0] : [0, 0, 1])), u = cross(s, f);
        const pixel = (scene.isParallel ? 2 * scene.halfHeight : 1.4 * scene.radius / scene.zoom) / canvas.clientHeight;
        scene.target = scene.target.map((x, k) => x - pixel * (dx * s[k] - dy * u[k]));
      }
    }
    touches.set(e.pointerId, [e.clientX, e.clientY]);
    draw();
  });
  canvas.addEventListener('wheel', (e) => { e.preventDefault(); scene.zoom *= Math.exp(-e.deltaY * 0.0012); draw(); }, { passive: false });
  canvas.addEventListener('dblclick', () => { scene.reset(); draw(); });
  canvas.addEventListener('webglcontextlost', () => { $('fault').textContent = 'The graphics were lost; reload the page.'; });

  for (const event of meta.events) {
    const mark = document.createElement('button');
    mark.textContent = `${label(event.t)} s  ${event.name}`;
    mark.addEventListener('click', () => { play(false); go(event.t); });
    $('events').append(mark);
    const tick_ = document.createElement('i');
    tick_.style.left = `${100 * event.t / meta.duration}%`;
    tick_.title = event.name;
    $('marks').append(tick_);
  }
  if (meta.gauges.length) {
    meta.gauges.forEach((gauge, k) => $('gauge').add(new Option(`${gauge.name} (${gauge.unit})`, k)));
    $('gauge').addEventListener('change', () => showGauge(Number($('gauge').value)));
    showGauge(0);
    let width = 0;
    window.addEventListener('resize', () => { if (width !== window.innerWidth) { width = window.innerWidth; showGauge(Number($('gauge').value)); } });
  } else $('gauges').hidden = true;

  window.addEventListener('beforeprint', () => {
    const kept = now, ratio = canvas.clientHeight / canvas.clientWidth || 0.5;
    canvas.width = 1200; canvas.height = Math.round(1200 * ratio);
    scene.isCoarse = false;
    $('stills').innerHTML = '';
    for (const share of [0, 1 / 3, 2 / 3, 1]) {
      now = share * meta.duration; draw();
      const figure = document.createElement('figure');
      figure.innerHTML = `<img alt="" src="${canvas.toDataURL('image/png')}"><figcaption>${now.toFixed(2)} s</figcaption>`;
      $('stills').append(figure);
    }
    now = kept; resize();
  });
  window.addEventListener('resize', resize);
  setView(scene.view);
  resize();
  const at = /^#t=([\d.]+)/.exec(location.hash);
  if (at) go(Number(at[1]));

  const sums = [['water', data.water], ['blocks', data.poses]].filter(([, frames]) => frames);
  const wrong = sums.filter(([name, frames]) => checksum(frames) !== meta[name].checksum || frames.length !== meta[name].times.length);
  if (wrong.length) throw new Error(`numbers of ${wrong.map(([name]) => name)} are damaged`);
  const error = scene.gl.getError();
  if (error) throw new Error(`WebGL error ${error}`);
  document.title = `${meta.title} · riprap`;
  document.documentElement.dataset.state = 'ready';
}

main().catch((error) => {
  document.documentElement.dataset.state = 'failed';
  $('fault').textContent = `The run cannot be played: ${error.message}. Pictures and tables below are complete.`;
});
