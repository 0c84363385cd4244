// window.register: the work, its history, and everything that can be done to it. The page and scripts use the same calls.
// Lengths are in metres, measured from the tile's first corner along its two periods; yarns, points and crossings count from zero.

class Register {
  constructor(work) {
    this.work = work;
    this.past = []; this.future = []; this.listeners = []; this.before = null; this.cache = {};
  }

  // Calls back whenever the work has changed; `settled` is false while a hand still drags.
  onChange(listener) { this.listeners.push(listener); }

  // One change, to be undone as one. What throws leaves the work as it was.
  edit(change) {
    this.preview(change);
    return this.commit();
  }

  // A change that goes on, as of a dragged point: always from where it began, and kept when committed.
  preview(change) {
    const from = this.before || this.work, work = JSON.parse(JSON.stringify(from));
    this.answer = change(work);
    this.before = from;
    this.set(work, false);
  }

  commit() {
    if (!this.before) return undefined;
    this.past.push(this.before);
    if (this.past.length > 500) this.past.shift();
    this.before = null; this.future = [];
    this.settleOrders();
    this.set(this.work, true);
    return this.answer;
  }

  set(work, settled) {
    this.work = work; this.cache = {};
    this.listeners.forEach(listener => listener(settled));
  }

  undo() { return this.step(this.past, this.future); }
  redo() { return this.step(this.future, this.past); }
  step(from, to) {
    this.commit();
    if (!from.length) return false;
    to.push(this.work);
    this.set(from.pop(), true);
    return true;
  }

  // Decisions about crossings go along with them; those whose crossing is gone are forgotten.
  settleOrders() {
    this.cache = {};
    const found = this.drawn().crossings;
    this.work.orders = found.filter(c => c.why === "click").map(c => this.decision(c, c.over));
    this.cache = {};
  }

  decision(crossing, over) {
    return { over: crossing.ends[over][0], under: crossing.ends[1 - over][0], end: over, at: crossing.at };
  }

  yarn(work, index) {
    if (!work.yarns[index]) throw new Error(`There is no yarn ${index}; there are ${work.yarns.length}.`);
    return work.yarns[index];
  }

  point(work, yarn, index) {
    const point = this.yarn(work, yarn).points[index];
    if (!point) throw new Error(`There is no point ${index} on yarn ${yarn}.`);
    return point;
  }

  place(work, at) {
    if (!Array.isArray(at) || at.length !== 2 || !at.every(x => Number.isFinite(x) && Math.abs(x) < 1e3)) throw new Error("A place is two lengths in metres.");
    return at.map((x, k) => x / work.periods_m[k]);
  }

  addYarn({ name, color } = {}) {
    return this.edit(work => {
      if (work.yarns.length >= MOST_YARNS) throw new Error(`A tile has at most ${MOST_YARNS} yarns.`);
      const taken = work.yarns.map(yarn => yarn.color), free = COLORS.find(c => !taken.includes(c));
      const names = work.yarns.map(yarn => yarn.name);
      let number = work.yarns.length + 1;
      while (names.includes(`yarn ${number}`)) number++;
      work.yarns.push({ name: name || `yarn ${number}`, color: color || free || COLORS[work.yarns.length % COLORS.length], closes: null, points: [] });
      return work.yarns.length - 1;
    });
  }

  removeYarn(yarn) { this.edit(work => { this.yarn(work, yarn); removeYarn(work, yarn); }); }
  renameYarn(yarn, name) { this.edit(work => { this.yarn(work, yarn).name = String(name).slice(0, 60) || `yarn ${yarn + 1}`; }); }
  setColor(yarn, color) { this.edit(work => { this.yarn(work, yarn).color = color; }); }

  // A point at the end of a yarn, or before the point `index`.
  addPoint(yarn, at, layer = "front", index = Infinity) {
    return this.edit(work => {
      const points = this.yarn(work, yarn).points, place = Math.min(Math.max(index, 0), points.length);
      if (points.length >= MOST_POINTS) throw new Error(`A yarn has at most ${MOST_POINTS} points.`);
      points.splice(place, 0, { at: this.place(work, at), layer: this.layer(layer) });
      return place;
    });
  }

  layer(name) {
    if (!LAYERS.includes(name)) throw new Error(`A layer is one of ${LAYERS.join(", ")}, not ${name}.`);
    return name;
  }

  movePoint(yarn, point, at) { this.edit(work => { this.point(work, yarn, point).at = this.place(work, at); }); }
  setLayer(yarn, point, layer) { this.edit(work => { this.point(work, yarn, point).layer = this.layer(layer); }); }
  removePoint(yarn, point) { this.edit(work => { this.point(work, yarn, point); work.yarns[yarn].points.splice(point, 1); }); }
  reverse(yarn) {
    this.edit(work => {
      const found = this.yarn(work, yarn);
      found.points.reverse();
      found.closes = found.closes && found.closes.map(k => -k || 0);
    });
  }

  // Leads the last point on to the image of the first one so many periods away; the likeliest one if none is named.
  close(yarn, closes) {
    return this.edit(work => {
      const found = this.yarn(work, yarn);
      if (!found.points.length) throw new Error(`${found.name} has no points.`);
      const to = closes || likelyClosing(work, found);
      if (!to.every(k => Number.isInteger(k) && Math.abs(k) <= MOST_TILES)) throw new Error(`A yarn closes a whole number of periods away, at most ${MOST_TILES}.`);
      return found.closes = to.slice();
    });
  }
  open(yarn) { this.edit(work => { this.yarn(work, yarn).closes = null; }); }

  setTile(tile, pointsStay = true) { this.edit(work => this.moveTile(work, tile, pointsStay)); }
  moveTile(work, tile, pointsStay) {
    const [u, v] = [tile.along_px, tile.across_px];
    if (!(Math.abs(u[0] * v[1] - u[1] * v[0]) > 16)) throw new Error("The tile has next to no area.");
    placeTile(work, JSON.parse(JSON.stringify(tile)), pointsStay);
  }
  setPeriods(periods) {
    if (!periods.every(p => p > 0 && p < 1e3)) throw new Error("Periods are two positive lengths in metres.");
    this.edit(work => setPeriodsOf(work, periods));
  }
  setRadius(radius) {
    if (!(radius > 0 && radius < 1)) throw new Error("The radius is a positive length in metres.");
    this.edit(work => { work.radius_m = radius; });
  }
  setSpacing(spacing) {
    if (!(spacing >= 0.25 && spacing <= 4)) throw new Error("Vertices lie 0.25 to 4 radii apart.");
    this.edit(work => { work.spacing_radii = spacing; });
  }
  setBack(back) { this.edit(work => { Object.assign(work.back, back); }); }

  // Curves and crossings in the plane, and the tile in space; both computed when first asked for.
  drawn() { return this.cache.drawn ||= drawnTile(this.work); }
  solve() { return this.cache.solved ||= solvedTile(this.work); }

  crossings() {
    return this.drawn().crossings.map(c => ({
      yarns: c.ends.map(end => end[0]), shift: c.shift, at: c.at, why: c.why,
      over: c.over === null ? null : c.ends[c.over][0], end: c.over,
    }));
  }

  // Puts the other yarn of a crossing above; where there is no order yet, the first one.
  swap(index) {
    const crossing = this.drawn().crossings[index];
    if (!crossing) throw new Error(`There is no crossing ${index}.`);
    const over = crossing.over === null ? 0 : 1 - crossing.over;
    this.edit(work => {
      work.orders = work.orders.filter((_, o) => o !== crossing.order);
      work.orders.push(this.decision(crossing, over));
    });
  }

  faults() { return this.solve().faults.map(fault => fault.text); }
  remarks() { return this.solve().remarks.map(remark => remark.text); }

  // The text of the .pyp file; an error with all faults where there are any.
  exportPattern() {
    const tile = this.solve();
    if (tile.faults.length) throw new Error(tile.faults.map(fault => fault.text).join("\n"));
    return patternText(this.work, tile);
  }

  save() { return writeWork(this.work); }
  load(text) {
    const work = readWork(text);
    this.edit(old => { for (const key of Object.keys(old)) delete old[key]; Object.assign(old, work); });
  }
}
