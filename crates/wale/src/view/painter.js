// What WebGL draws: yarns as capsules cast in the fragment shader, obstacles as meshes, the lamp's shadow.

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
