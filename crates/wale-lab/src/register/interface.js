// The page: hands on the canvas and keys, and the two ways in: photographs of the page, or work that was kept.

const NEAR_POINT = 10, NEAR_CURVE = 8, NEAR_CROSSING = 9, NEAR_RING = 11, A_MOVE = 4;

class Page {
  constructor(facts, photographs) {
    const size = [photographs.front.naturalWidth, photographs.front.naturalHeight];
    this.facts = facts; this.size = size; this.hasBack = !!photographs.back; this.name = facts.name;
    this.keep = `wale-register ${facts.name} ${size} ${facts.periods_m} ${facts.radius_m}`;
    this.register = new Register(newWork({ periods: facts.periods_m, radius: facts.radius_m, scale: facts.scale_m, size }));
    this.register.work.back.mirrored = facts.mirrored;
    this.look = {
      mode: "yarns", blend: 0, photo: 1, yarn: 0.8, style: "bands", neighbours: 1, crossings: true, solved: null,
      yarnIndex: 0, pointIndex: null, crossingIndex: null, newLayer: "front",
      rectangle: true, lockScale: facts.scale_m !== null, pointsStay: true,
    };
    $("lock-scale").checked = this.look.lockScale;
    this.painter = new Painter($("canvas"), photographs);
    this.panel = new Panel(this);
    document.title = facts.title;
    document.querySelector("h1").textContent = facts.title;
    document.querySelectorAll("[data-needs-back], [data-mode=back]").forEach(e => { e.hidden = !this.hasBack; });
    this.restore();
    this.register.onChange(settled => { this.inRange(); this.changed(settled); if (settled) this.remember(); });
    this.hands();
    window.addEventListener("keydown", event => this.key(event));
    new ResizeObserver(() => this.resized()).observe($("canvas"));
    this.fit();
    this.changed(true);
  }

  // Work of an earlier visit, where the browser keeps any.
  restore() {
    try {
      const kept = localStorage.getItem(this.keep);
      if (kept) { this.register.load(kept); this.say("Went on with the work that this browser had kept. Undo takes it away."); }
    } catch (error) { this.kept = false; }
  }
  remember() {
    try { localStorage.setItem(this.keep, this.register.save()); } catch (error) { this.kept = false; }
  }
  saveWork() { download(`${this.name}.json`, this.register.save(), "application/json"); }

  changed(settled) { this.panel.update(settled); this.redraw(); }
  redraw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.painter.draw(this.register, this.look); });
  }
  say(text) { $("said").textContent = text; }
  attempt(does) {
    this.say("");
    try { does(); } catch (error) { this.say(error.message); }
    this.changed(true);
  }

  inRange() {
    const { yarns } = this.register.work, look = this.look;
    look.yarnIndex = Math.min(look.yarnIndex, Math.max(yarns.length - 1, 0));
    const yarn = yarns[look.yarnIndex];
    if (look.pointIndex !== null && (!yarn || look.pointIndex >= yarn.points.length)) look.pointIndex = null;
    look.crossingIndex = null; look.solved = null;
  }
  choose(yarn, point) { Object.assign(this.look, { yarnIndex: yarn, pointIndex: point }); this.inRange(); this.changed(true); }
  yarn() { return this.register.work.yarns[this.look.yarnIndex]; }
  point() { const yarn = this.yarn(); return yarn && this.look.pointIndex !== null ? yarn.points[this.look.pointIndex] : null; }
  isOpen() { const yarn = this.yarn(); return !!yarn && !yarn.closes; }

  setMode(mode) { this.look.mode = mode; if (mode === "back") this.setBlend(0.5); this.changed(true); }
  setBlend(blend) { this.look.blend = blend; $("blend").value = blend; this.redraw(); }
  fit() { this.painter.fit([[0, 0], this.size]); this.fitted = { ...this.painter.view }; this.redraw(); }
  // A window of another size shows the whole photograph as long as nobody has looked closer; at once, since a canvas that is
  // stretched until the next picture would flicker.
  resized() {
    const { view } = this.painter;
    if (Object.keys(view).every(key => view[key] === this.fitted[key])) this.fit();
    this.painter.draw(this.register, this.look);
  }

  setLayer(layer) {
    this.attempt(() => {
      this.look.newLayer = layer;
      if (this.point()) this.register.setLayer(this.look.yarnIndex, this.look.pointIndex, layer);
    });
  }
  newYarn() { this.choose(this.register.addYarn(), null); }
  closeYarn() { this.yarn().closes ? this.register.open(this.look.yarnIndex) : this.register.close(this.look.yarnIndex); }
  deletePoint() {
    if (!this.point()) return;
    const { yarnIndex, pointIndex } = this.look;
    this.register.removePoint(yarnIndex, pointIndex);
    this.choose(yarnIndex, pointIndex > 0 ? pointIndex - 1 : null);
  }
  goTo({ at, yarn }) {
    if (Number.isInteger(yarn)) this.choose(yarn, null);
    if (!at) return;
    const { work } = this.register, inside = at.map((x, k) => x - work.periods_m[k] * Math.floor(x / work.periods_m[k]));
    const [x, y] = this.painter.metres(work, inside), { clientWidth, clientHeight } = $("canvas");
    this.painter.view.x += clientWidth / 2 - x;
    this.painter.view.y += clientHeight / 2 - y;
    this.redraw();
  }

  // The tile.
  turnTile(angle) {
    this.register.edit(work => {
      const { along_px: u } = work.tile, by = -angle - Math.atan2(u[1], u[0]), [c, s] = [Math.cos(by), Math.sin(by)];
      const turned = ([x, y]) => [c * x - s * y, s * x + c * y];
      this.register.moveTile(work, { ...work.tile, along_px: turned(u), across_px: turned(work.tile.across_px) }, this.look.pointsStay);
    });
  }
  scaleTile(scale) {
    if (!(scale > 0)) throw new Error("A scale is a positive number of micrometres a pixel.");
    this.register.edit(work => this.register.moveTile(work, this.sized(work, work.tile, scale), this.look.pointsStay));
  }
  // The tile with sides as long as the periods are at a scale [m/px].
  sized(work, tile, scale) {
    const side = (vector, k) => vector.map(x => x / Math.hypot(...vector) * work.periods_m[k] / scale);
    return { ...tile, along_px: side(tile.along_px, 0), across_px: side(tile.across_px, 1) };
  }
  // The tile when a corner is drawn to a pixel: 1 the end of the first side, 3 of the second, 2 the one opposite.
  drawCorner(work, corner, pixel) {
    const { origin_px: o, along_px: u, across_px: v } = work.tile, d = [pixel[0] - o[0], pixel[1] - o[1]];
    const long = Math.hypot, side = Math.sign(u[0] * v[1] - u[1] * v[0]) || 1;
    const square = (w, length, sign) => [-w[1], w[0]].map(x => sign * x / long(...w) * length);
    let tile = { origin_px: o, along_px: u, across_px: v };
    if (corner === 1) tile = { ...tile, along_px: d, across_px: this.look.rectangle ? square(d, long(...v), side) : v };
    if (corner === 3) tile = { ...tile, across_px: d, along_px: this.look.rectangle ? square(d, long(...u), -side) : u };
    if (corner === 2) {
      const [a, b] = fromPixel(work, pixel);
      tile = { ...tile, along_px: u.map(x => x * Math.max(a, 0.05)), across_px: v.map(x => x * Math.max(b, 0.05)) };
    }
    if (this.look.lockScale) tile = this.sized(work, tile, Math.sqrt(scalesOf(work)[0] * scalesOf(work)[1]));
    this.register.moveTile(work, tile, this.look.pointsStay);
  }

  // What lies under a place on the screen in the mode of yarns.
  under(place) {
    const { work } = this.register, { painter, look } = this, images = painter.images(look.neighbours).reverse();
    const away = other => Math.hypot(other[0] - place[0], other[1] - place[1]);
    let best = { distance: NEAR_POINT, kind: "nothing" };
    const take = found => { if (found.distance < best.distance) best = found; };
    work.yarns.forEach((yarn, y) => yarn.points.forEach((point, p) => {
      // The chosen yarn first, where points of two lie on each other.
      take({ distance: away(painter.part(work, point.at)) - (y === look.yarnIndex ? 2 : 0), kind: "point", yarn: y, point: p });
    }));
    if (best.kind === "point") return best;
    const yarn = this.yarn();
    if (yarn && !yarn.closes && yarn.points.length) {
      best.distance = NEAR_RING;
      for (const k of images.filter(k => k[0] || k[1])) take({ distance: away(painter.part(work, yarn.points[0].at.map((x, a) => x + k[a]))), kind: "ring", closes: k });
      if (best.kind === "ring") return best;
    }
    best.distance = NEAR_CROSSING;
    for (const k of images) this.register.drawn().crossings.forEach((c, index) => take({ distance: away(painter.metres(work, c.at, k)), kind: "crossing", index }));
    return best;
  }

  // The curve next to a place: yarn, piece and whether it is near enough.
  curveAt(place, only) {
    const { work } = this.register, at = fromPixel(work, this.painter.fromScreen(place)).map((x, k) => x * work.periods_m[k]);
    const near = NEAR_CURVE / this.painter.view.scale * Math.sqrt(scalesOf(work)[0] * scalesOf(work)[1]);
    let best = null;
    this.register.drawn().lines.forEach((line, yarn) => {
      if (only !== undefined && only !== yarn) return;
      for (const k of this.painter.images(this.look.neighbours)) {
        const found = nearestOnLine(line, at.map((x, a) => x - k[a] * work.periods_m[a]));
        if (found.distance < near && (!best || found.distance < best.distance)) best = { ...found, yarn };
      }
    });
    return best;
  }

  placeOf(screen) {
    const { work } = this.register;
    return fromPixel(work, this.painter.fromScreen(screen)).map((x, k) => x * work.periods_m[k]);
  }
}

function photograph(id) {
  const uri = $(id).textContent;
  $(id).textContent = "";
  if (!uri) return null;
  const image = new Image();
  return new Promise((done, refused) => {
    image.onload = () => done(image);
    image.onerror = () => refused(new Error(`The browser cannot show the ${id} photograph: it is damaged, or of an unusual kind.`));
    image.src = uri;
  });
}

async function start() {
  const facts = JSON.parse($("facts").textContent);
  const [front, back] = await Promise.all(["front", "back"].map(photograph));
  const page = new Page(facts, { front, back });
  window.register = page.register;
  window.registerPage = page;
  document.body.dataset.state = "ready";
  window.dispatchEvent(new Event("register-ready"));
}

function fail(error) {
  $("error").hidden = false;
  $("error").textContent = "The page cannot go on.\n\n" + (error && error.message || error);
  document.body.dataset.state = "error";
}
window.addEventListener("error", event => { if (!/ResizeObserver/.test(event.message)) fail(event.error || event.message); });
