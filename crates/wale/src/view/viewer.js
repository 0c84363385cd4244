// The page itself: what is drawn, when, and how hands turn it.

const $ = id => document.getElementById(id);

function fail(error) {
  $("error").style.display = "block";
  $("error").textContent = "The fabric cannot be shown.\n\n" + (error && error.message || error);
  document.body.dataset.state = "error";
}
window.addEventListener("error", e => fail(e.error || e.message));
window.addEventListener("unhandledrejection", e => fail(e.reason));

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
