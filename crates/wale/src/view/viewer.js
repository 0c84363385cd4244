// The page itself: what is drawn, when, and how hands turn it.

const $ = id => document.getElementById(id);

function fail(error) {
  $("error").style.display = "block";
  $("error").textContent = "The fabric cannot be shown.\n\n" + (error && error.message || error);
  document.body.dataset.state = "error";
}
window.addEventListener("error", e => fail(e.error || e.message));
window.addEventListener("unhandledrejection", e => fail(e.reason));

const TEXELS = 2048;                      // width of the textures that hold one texel a point
const SLOPE = Math.tan(12 * Math.PI / 180); // half the angle of view, as a tangent
const SHADOW = 2048;
const VIEWS = {
  front: { back: [0, 0, 1], up: [0, 1, 0] },
  back: { back: [0, 0, -1], up: [0, 1, 0] },
  "three-quarter": { back: [0.42, -0.8, 0.82], up: [0, 0, 1] },
};

function unit(v) { const l = Math.hypot(...v); return v.map(x => x / l); }
function cross(a, b) { return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]; }

async function start() {
  const facts = JSON.parse($("facts").textContent);
  document.title = facts.title;
  $("title").querySelector("h1").textContent = facts.title;
  $("title").querySelector("p").textContent = facts.notice;
  const gl = $("view").getContext("webgl2", { antialias: false, alpha: false });
  if (!gl) throw new Error("This browser offers no WebGL 2. Try another browser, or allow hardware acceleration.");
  const frames = await unpack(facts, $("numbers").textContent);
  $("numbers").textContent = "";
  const painter = new Painter(gl, facts, frames);
  const page = new Page(painter, facts);
  page.fromAddress();
  window.addEventListener("hashchange", () => page.fromAddress());
  page.draw();
  document.body.dataset.state = "ready";
}

// Draws one frame from one eye.
class Painter {
  constructor(gl, facts, frames) {
    this.gl = gl; this.facts = facts; this.frames = frames;
    this.yarn = this.program("yarn.vert", "yarn.frag");
    this.solid = this.program("solid.vert", "solid.frag");
    this.compose = this.program("compose.vert", "compose.frag");
    this.rows = Math.max(1, Math.ceil(facts.points / TEXELS));
    if (this.rows > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new Error("The fabric has more points than this graphics card holds in a texture.");
    this.points = this.texture(gl.NEAREST);
    this.normals = this.texture(gl.NEAREST);
    this.pointData = new Uint16Array(4 * TEXELS * this.rows);
    this.normalData = new Int8Array(4 * TEXELS * this.rows);
    this.empty = gl.createVertexArray();
    this.makeYarns();
    this.makeMaps();
    this.meshes = new Map();
    this.shadow = this.texture(gl.LINEAR);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.DEPTH_COMPONENT24, SHADOW, SHADOW, 0, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT, null);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL);
    this.shadowTarget = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowTarget);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.shadow, 0);
    gl.drawBuffers([gl.NONE]);
    this.colors = this.texture(gl.LINEAR);
    this.depths = this.texture(gl.NEAREST);
    this.target = gl.createFramebuffer();
    this.loaded = [-1, -2];
  }

  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, id] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, $(id).textContent.trim());
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(id + ": " + gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(fragment + ": " + gl.getProgramInfoLog(program));
    const at = {};
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    for (let i = 0; i < count; ++i) {
      const name = gl.getActiveUniform(program, i).name;
      at[name] = gl.getUniformLocation(program, name);
    }
    return { program, at };
  }

  texture(filter) {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, key, filter);
    for (const key of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, key, gl.CLAMP_TO_EDGE);
    return texture;
  }

  bind(unit, texture) {
    this.gl.activeTexture(this.gl.TEXTURE0 + unit);
    this.gl.bindTexture(this.gl.TEXTURE_2D, texture);
  }

  makeYarns() {
    const gl = this.gl, facts = this.facts;
    const linear = c => { c /= 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; };
    const info = new Float32Array(4 * TEXELS * Math.ceil(facts.yarns.length / TEXELS));
    const ids = [], spins = [];
    facts.yarns.forEach((yarn, y) => {
      info.set([...yarn.color.map(linear), yarn.radius], 4 * y);
      for (let k = facts.start[y]; k + 1 < facts.start[y + 1]; ++k) {
        ids.push(k, (k === facts.start[y] ? 1 : 0) | (k + 2 === facts.start[y + 1] ? 2 : 0), y);
        const u = yarn.first + (k - facts.start[y]) * yarn.spacing;
        spins.push((facts.twist * u) % 1, facts.twist * yarn.spacing, (u / yarn.radius) % 4096, yarn.spacing / yarn.radius);
      }
    });
    this.segments = ids.length / 3;
    this.yarnInfo = this.texture(gl.NEAREST);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, TEXELS, info.length / 4 / TEXELS, 0, gl.RGBA, gl.FLOAT, info);
    // Fewer pieces to a segment where there are many: the eye is then farther away.
    this.pieces = this.segments > 120000 ? 2 : this.segments > 40000 ? 3 : 4;
    this.yarnArray = gl.createVertexArray();
    gl.bindVertexArray(this.yarnArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Uint32Array(ids), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribIPointer(0, 3, gl.UNSIGNED_INT, 0, 0);
    gl.vertexAttribDivisor(0, this.pieces);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(spins), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 4, gl.FLOAT, false, 0, 0);
    gl.vertexAttribDivisor(1, this.pieces);
    gl.bindVertexArray(null);
    this.radius = Math.max(...facts.yarns.map(y => y.radius));
  }

  makeMaps() {
    const gl = this.gl;
    this.maps = this.facts.quantities.map(quantity => {
      const texture = this.texture(gl.LINEAR);
      gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, quantity.map.length, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array(quantity.map.flat()));
      return texture;
    });
  }

  load(index, quantity) {
    if (this.loaded[0] === index && this.loaded[1] === quantity) return;
    const gl = this.gl, frame = this.frames[index], data = this.pointData;
    const [x, y, z] = frame.place, value = quantity >= 0 ? frame.value[quantity] : null;
    for (let i = 0; i < this.facts.points; ++i) {
      data[4 * i] = x[i]; data[4 * i + 1] = y[i]; data[4 * i + 2] = z[i]; data[4 * i + 3] = value ? value[i] : 0;
    }
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    this.bind(0, this.points);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA16UI, TEXELS, this.rows, 0, gl.RGBA_INTEGER, gl.UNSIGNED_SHORT, data);
    if (this.loaded[0] !== index) {
      unspunNormals(this.facts, frame, this.normalData);
      this.bind(1, this.normals);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8_SNORM, TEXELS, this.rows, 0, gl.RGBA, gl.BYTE, this.normalData);
    }
    this.loaded = [index, quantity];
  }

  resize(width, height) {
    const gl = this.gl;
    if (this.size && this.size[0] === width && this.size[1] === height) return;
    this.size = [width, height];
    this.bind(0, this.colors);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    this.bind(0, this.depths);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.DEPTH_COMPONENT24, width, height, 0, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.colors, 0);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.depths, 0);
    if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE) throw new Error("The graphics card refuses a picture of " + width + " by " + height + " pixels.");
  }

  // eye: { target, right, up, back, distance }; `finer` rays a pixel along each side.
  draw(index, quantity, eye, finer) {
    const gl = this.gl, canvas = gl.canvas, facts = this.facts;
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    if (Math.max(canvas.width, canvas.height) * finer > most) finer = 1;
    this.load(index, quantity);
    this.resize(canvas.width * finer, canvas.height * finer);
    const aspect = canvas.width / canvas.height;
    const near = Math.max(eye.distance - 3 * facts.extent, eye.distance * 0.02), far = eye.distance + 6 * facts.extent;
    const from = eye.target.map((t, k) => t + eye.distance * eye.back[k]);
    const view = Matrix.frame(eye.right, eye.up, eye.back, from);
    const projection = Matrix.perspective(SLOPE, aspect, near, far);
    const key = unit([-0.62, 0.62, 0.60]);
    const side = unit(cross([0, 1, 0], key)), above = cross(key, side);
    // The lamp's picture holds the whole fabric, whatever the eye sees of it.
    const middle = [0, 1, 2].map(r => view[r] * facts.middle[0] + view[4 + r] * facts.middle[1] + view[8 + r] * facts.middle[2] + view[12 + r]);
    const half = 0.62 * facts.extent + 4 * this.radius;
    const lampFrom = middle.map((m, k) => m + 2 * half * key[k]);
    const toLamp = Matrix.frame(side, above, key, lampFrom);
    const lampView = Matrix.multiply(toLamp, view);
    const lampProjection = Matrix.parallel(half, 0.5 * half, 3.5 * half);
    const toMap = new Float32Array([0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0.5, 0.5, 0.5, 1]);
    const shade = Matrix.multiply(toMap, Matrix.multiply(lampProjection, toLamp));
    gl.enable(gl.DEPTH_TEST);

    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowTarget);
    gl.viewport(0, 0, SHADOW, SHADOW);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    const common = { index, quantity, key, shade, half };
    this.scene({ ...common, view: lampView, projection: lampProjection, parallel: true, depthOnly: true, pixel: 1 });

    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, this.size[0], this.size[1]);
    const back = facts.background.map(c => c / 255);
    gl.clearColor(back[0], back[1], back[2], 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.scene({ ...common, view, projection, parallel: false, depthOnly: false, pixel: 2 * SLOPE / this.size[1] * finer });

    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.disable(gl.DEPTH_TEST);
    const { program, at } = this.compose;
    gl.useProgram(program);
    this.bind(0, this.colors); gl.uniform1i(at.uColor, 0);
    this.bind(1, this.depths); gl.uniform1i(at.uDepth, 1);
    gl.uniform2f(at.uSize, canvas.width, canvas.height);
    gl.uniform2f(at.uClip, near, far);
    gl.uniform2f(at.uHalf, SLOPE * aspect, SLOPE);
    gl.uniform1f(at.uReach, 5 * this.radius);
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  scene(s) {
    const gl = this.gl, facts = this.facts, frame = facts.frames[s.index];
    const shared = at => {
      gl.uniformMatrix4fv(at.uView, false, s.view);
      gl.uniformMatrix4fv(at.uProjection, false, s.projection);
      gl.uniform1i(at.uDepthOnly, s.depthOnly);
      gl.uniform3fv(at.uKey, s.key);
      gl.uniformMatrix4fv(at.uToLamp, false, s.shade);
      gl.uniform1f(at.uShadowOn, s.depthOnly ? 0 : 1);
      gl.uniform1f(at.uShadowTexel, 1 / SHADOW);
      // While the lamp's picture is being drawn it must not be read.
      this.bind(4, s.depthOnly ? null : this.shadow); gl.uniform1i(at.uShadow, 4);
    };
    let { program, at } = this.yarn;
    gl.useProgram(program);
    shared(at);
    this.bind(0, this.points); gl.uniform1i(at.uPoints, 0);
    this.bind(1, this.normals); gl.uniform1i(at.uNormals, 1);
    this.bind(2, this.yarnInfo); gl.uniform1i(at.uYarns, 2);
    this.bind(3, s.quantity >= 0 ? this.maps[s.quantity] : this.yarnInfo); gl.uniform1i(at.uMap, 3);
    gl.uniform1i(at.uByValue, s.quantity >= 0);
    gl.uniform1i(at.uParallel, s.parallel);
    gl.uniform1i(at.uPieces, this.pieces);
    gl.uniform3fv(at.uOrigin, frame.origin);
    gl.uniform1f(at.uStep, facts.step);
    gl.uniform1f(at.uPlies, facts.plies);
    gl.uniform1f(at.uSlope, 2 * Math.PI * facts.twist * this.radius);
    gl.uniform1f(at.uPixel, s.pixel);
    gl.bindVertexArray(this.yarnArray);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.segments * this.pieces);

    if (frame.solids.length === 0) return;
    ({ program, at } = this.solid);
    gl.useProgram(program);
    shared(at);
    gl.uniform3fv(at.uBackground, facts.background.map(c => c / 255));
    gl.uniform1f(at.uLift, this.radius);
    for (const solid of frame.solids) {
      if (s.depthOnly && solid.shape === "plane") continue;
      const mesh = this.mesh(solid);
      gl.uniformMatrix4fv(at.uModel, false, Matrix.place(solid.rotation, solid.position, [1, 1, 1]));
      gl.uniform3fv(at.uColor, solid.color.map(c => { c /= 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; }));
      gl.uniform1f(at.uEndless, solid.shape === "plane" ? 3 * facts.extent : 0);
      gl.bindVertexArray(mesh.array);
      gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
    }
  }

  mesh(solid) {
    const gl = this.gl, name = JSON.stringify([solid.shape, solid.radius, solid.half_length, solid.half_extents]);
    if (!this.meshes.has(name)) {
      const data = solidMesh(solid, 3 * this.facts.extent);
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      for (const [slot, from] of [[0, 0], [1, 12]]) {
        gl.enableVertexAttribArray(slot);
        gl.vertexAttribPointer(slot, 3, gl.FLOAT, false, 24, from);
      }
      this.meshes.set(name, { array, count: data.length / 6 });
    }
    return this.meshes.get(name);
  }
}

// Buttons, hands and the address.
class Page {
  constructor(painter, facts) {
    this.painter = painter; this.facts = facts;
    this.frame = 0; this.quantity = -1; this.playing = false; this.waiting = false;
    this.look("three-quarter");
    const last = facts.frames.length - 1;
    $("scrub").max = last;
    for (const id of ["play", "scrub"]) $(id).hidden = last === 0;
    facts.quantities.forEach(q => $("color").add(new Option(q.name, q.name)));
    $("play").onclick = () => this.play(!this.playing);
    $("scrub").oninput = () => { this.play(false); this.show(+$("scrub").value); };
    $("color").onchange = () => this.colorBy($("color").value);
    document.querySelectorAll("[data-view]").forEach(b => b.onclick = () => { this.look(b.dataset.view); this.redraw(); });
    window.addEventListener("resize", () => this.redraw());
    window.addEventListener("keydown", e => this.key(e));
    this.hands($("view"));
    $("view").addEventListener("webglcontextlost", () => fail("The graphics card dropped the picture; load the page again."));
    this.legend();
  }

  // The state that the address asks for: #frame=12&color=stretch&view=front
  fromAddress() {
    const asked = new URLSearchParams(location.hash.slice(1));
    if (asked.has("view")) {
      if (!VIEWS[asked.get("view")]) throw new Error("The address asks for an unknown view: " + asked.get("view"));
      this.look(asked.get("view"));
    }
    if (asked.has("color")) this.colorBy(asked.get("color"));
    if (asked.has("frame")) this.show(parseInt(asked.get("frame"), 10) - 1);
    this.redraw();
  }

  look(name) {
    const { back, up } = VIEWS[name], facts = this.facts;
    const b = unit(back), right = unit(cross(up, b));
    const aspect = Math.max(0.2, $("view").clientWidth / Math.max(1, $("view").clientHeight));
    // The fabric's box, seen from here, decides the distance.
    const above = cross(b, right);
    const span = axis => axis.reduce((sum, a, k) => sum + Math.abs(a) * facts.size[k], 0) / 2;
    const distance = 1.12 * Math.max(span(above) / SLOPE, span(right) / (SLOPE * aspect)) + span(b);
    this.eye = { target: facts.middle.slice(), right, up: above, back: b, distance };
  }

  show(index) {
    const count = this.facts.frames.length;
    this.frame = Math.min(Math.max(Number.isFinite(index) ? index : 0, 0), count - 1);
    this.redraw();
  }

  colorBy(name) {
    const index = this.facts.quantities.findIndex(q => q.name === name);
    if (index < 0 && name !== "yarn") throw new Error("The page has no colours for: " + name);
    this.quantity = index;
    $("color").value = name;
    this.legend();
    this.redraw();
  }

  legend() {
    const box = $("legend"), quantity = this.facts.quantities[this.quantity];
    box.hidden = !quantity;
    if (!quantity) return;
    box.querySelector("span").textContent = quantity.name + " [" + quantity.unit + "]";
    const canvas = box.querySelector("canvas"), paint = canvas.getContext("2d");
    const pixels = paint.createImageData(256, 1);
    quantity.map.forEach((c, i) => pixels.data.set([...c, 255], 4 * i));
    paint.putImageData(pixels, 0, 0);
    const [low, high] = quantity.range;
    [low, (low + high) / 2, high].forEach((v, i) => {
      box.querySelectorAll(".ends span")[i].textContent = Math.abs(v) < 1e-9 * (high - low) ? "0" : String(+v.toPrecision(3));
    });
  }

  play(on) {
    this.playing = on && this.facts.frames.length > 1;
    $("play").textContent = this.playing ? "Pause" : "Play";
    if (this.playing) {
      if (this.frame === this.facts.frames.length - 1) this.frame = 0;
      this.since = performance.now() - this.frame * 1000 / 24;
      this.redraw();
    }
  }

  redraw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(now => { this.waiting = false; this.draw(now); });
  }

  draw(now) {
    if (this.playing) {
      const count = this.facts.frames.length;
      this.frame = Math.floor((now - this.since) * 24 / 1000);
      if (this.frame >= count) { this.since = now; this.frame = 0; }
      this.frame = Math.max(0, this.frame);
    }
    const moving = this.playing || this.held;
    this.painter.draw(this.frame, this.quantity, this.eye, moving && this.slow ? 1 : 2);
    const then = this.drawn || 0;
    this.drawn = performance.now();
    if (moving && this.drawn - then > 45 && this.drawn - then < 1000) this.slow = true;
    const facts = this.facts.frames[this.frame], count = this.facts.frames.length;
    $("scrub").value = this.frame;
    $("time").textContent = count > 1 ? facts.time.toFixed(3) + " s · frame " + (this.frame + 1) + " of " + count : facts.time.toFixed(3) + " s";
    this.scale();
    if (this.playing) this.redraw();
  }

  // The bar is true at the depth of the point that the eye turns about.
  scale() {
    const pixel = 2 * SLOPE * this.eye.distance / Math.max(1, $("view").clientHeight);
    const most = 200 * pixel * 1000, power = 10 ** Math.floor(Math.log10(most));
    const length = [5, 2, 1].map(m => m * power).find(l => l <= most) || power;
    $("scale").querySelector("div").style.width = length / (pixel * 1000) + "px";
    $("scale").querySelector("span").textContent = +length.toPrecision(2) + " mm";
  }

  key(e) {
    if (e.target.tagName === "SELECT") return;
    if (e.key === " ") { this.play(!this.playing); e.preventDefault(); }
    if (e.key === "ArrowRight" || e.key === "ArrowLeft") {
      this.play(false);
      this.show(this.frame + (e.key === "ArrowRight" ? 1 : -1));
      e.preventDefault();
    }
    if (e.key === "ArrowUp" || e.key === "ArrowDown") { this.zoom(e.key === "ArrowUp" ? 1 / 1.1 : 1.1); e.preventDefault(); }
  }

  zoom(factor) {
    const size = this.facts.extent;
    this.eye.distance = Math.min(Math.max(this.eye.distance * factor, 0.05 * size), 40 * size);
    this.redraw();
  }

  turn(dx, dy) {
    const eye = this.eye;
    for (const [axis, angle] of [[eye.up, -dx], [eye.right, -dy]]) {
      eye.right = turnAbout(eye.right, axis, angle);
      eye.up = turnAbout(eye.up, axis, angle);
      eye.back = turnAbout(eye.back, axis, angle);
    }
    eye.back = unit(eye.back);
    eye.right = unit(cross(eye.up, eye.back));
    eye.up = cross(eye.back, eye.right);
    this.redraw();
  }

  pan(dx, dy) {
    const eye = this.eye, pixel = 2 * SLOPE * eye.distance / Math.max(1, $("view").clientHeight);
    eye.target = eye.target.map((t, k) => t + pixel * (dy * eye.up[k] - dx * eye.right[k]));
    this.redraw();
  }

  // Drag turns, with shift or the right button it moves; the wheel or two fingers zoom; a double click starts again.
  hands(canvas) {
    const held = new Map();
    const spread = () => { const [a, b] = [...held.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
    canvas.onpointerdown = e => {
      canvas.setPointerCapture(e.pointerId);
      held.set(e.pointerId, [e.clientX, e.clientY]);
      this.held = true;
    };
    canvas.onpointermove = e => {
      if (!held.has(e.pointerId)) return;
      const [x, y] = held.get(e.pointerId), dx = e.clientX - x, dy = e.clientY - y;
      const before = held.size === 2 ? spread() : 0;
      held.set(e.pointerId, [e.clientX, e.clientY]);
      if (held.size === 2) {
        this.pan(dx / 2, dy / 2);
        this.zoom(before / Math.max(1, spread()));
      } else if (e.shiftKey || e.buttons & 6) this.pan(dx, dy);
      else this.turn(dx * 0.008, dy * 0.008);
    };
    canvas.onpointerup = canvas.onpointercancel = e => {
      held.delete(e.pointerId);
      this.held = held.size > 0;
      this.redraw();
    };
    canvas.oncontextmenu = e => e.preventDefault();
    canvas.addEventListener("wheel", e => { e.preventDefault(); this.zoom(Math.exp(Math.max(-1, Math.min(1, e.deltaY * 0.0015)))); }, { passive: false });
    canvas.ondblclick = () => { this.look("three-quarter"); this.redraw(); };
  }
}

start().catch(fail);
