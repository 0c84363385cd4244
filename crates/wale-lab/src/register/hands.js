// Mouse, pen and keys on the canvas.

Object.assign(Page.prototype, {
  hands() {
    const canvas = $("canvas");
    const place = event => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
    canvas.addEventListener("pointerdown", event => {
      canvas.focus();
      this.hold = this.grasp(place(event), event);
      if (this.hold) canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", event => {
      const { hold } = this;
      if (!hold) return;
      const at = place(event);
      if (!hold.moved && Math.hypot(at[0] - hold.from[0], at[1] - hold.from[1]) < A_MOVE) return;
      hold.moved = true;
      // A change that is refused on the way waits for a better place of the hand.
      try { hold.drag(at); } catch (error) { this.say(error.message); }
    });
    const release = event => {
      const { hold } = this;
      this.hold = null;
      if (!hold) return;
      if (hold.moved) this.register.commit(); else if (hold.click && event.type === "pointerup") this.attempt(hold.click);
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    canvas.addEventListener("dblclick", event => { if (this.look.mode === "yarns" && !this.isOpen()) this.attempt(() => this.insertAt(place(event))); });
    canvas.addEventListener("wheel", event => {
      event.preventDefault();
      this.painter.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), place(event));
      this.redraw();
    }, { passive: false });
  },

  // What a press takes hold of: { from, drag(place), click() }.
  grasp(from, event) {
    const view = { ...this.painter.view };
    const pan = at => { Object.assign(this.painter.view, { x: view.x + at[0] - from[0], y: view.y + at[1] - from[1] }); this.redraw(); };
    if (event.button !== 0) return { from, drag: pan };
    const begin = this.painter.fromScreen(from);
    const moved = at => { const now = this.painter.fromScreen(at); return [now[0] - begin[0], now[1] - begin[1]]; };
    if (this.look.mode === "tile") return this.graspTile(from, pan, moved);
    if (this.look.mode === "back") {
      return { from, drag: at => this.register.preview(work => { work.back.shift_px = work.back.shift_px.map((x, k) => x + moved(at)[k]); }) };
    }
    if (event.shiftKey) return { from, drag: pan, click: () => this.insertAt(from) };
    const found = this.under(from);
    if (found.kind === "point") {
      this.choose(found.yarn, found.point);
      const drag = at => this.register.preview(work => {
        const point = work.yarns[found.yarn].points[found.point];
        point.at = fromPixel(work, toPixel(work, point.at).map((x, k) => x + moved(at)[k]));
      });
      return { from, drag };
    }
    if (found.kind === "ring") return { from, drag: pan, click: () => this.register.close(this.look.yarnIndex, found.closes) };
    if (found.kind === "crossing" && (event.altKey || !this.isOpen())) {
      return { from, drag: pan, click: () => { this.register.swap(found.index); this.look.crossingIndex = found.index; } };
    }
    return { from, drag: pan, click: () => this.clickBeside(from) };
  },

  graspTile(from, pan, moved) {
    const { work } = this.register, corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(at => this.painter.part(work, at));
    const corner = corners.findIndex(c => Math.hypot(c[0] - from[0], c[1] - from[1]) < NEAR_POINT);
    const shift = at => this.register.preview(work => {
      const tile = { ...work.tile, origin_px: work.tile.origin_px.map((x, k) => x + moved(at)[k]) };
      this.register.moveTile(work, tile, this.look.pointsStay);
    });
    if (corner > 0) return { from, drag: at => this.register.preview(work => this.drawCorner(work, corner, this.painter.fromScreen(at))) };
    const inside = fromPixel(work, this.painter.fromScreen(from)).every(x => x >= 0 && x <= 1);
    return { from, drag: corner === 0 || inside ? shift : pan };
  },

  // A click beside everything: the next point of an open yarn, another yarn, or the first point of the first yarn.
  clickBeside(at) {
    const { work } = this.register;
    if (this.isOpen() || !work.yarns.length) {
      if (!work.yarns.length) this.look.yarnIndex = this.register.addYarn();
      const { yarnIndex, newLayer } = this.look;
      this.choose(yarnIndex, this.register.addPoint(yarnIndex, this.placeOf(at), newLayer));
      return;
    }
    const curve = this.curveAt(at);
    if (curve) this.choose(curve.yarn, null);
    else { this.choose(this.look.yarnIndex, null); this.say("This yarn is closed: press N for a new one, or Shift and click on its curve for a point in between."); }
  },

  // A new point on the curve of the chosen yarn.
  insertAt(at) {
    const { yarnIndex, newLayer } = this.look, curve = this.curveAt(at, yarnIndex);
    if (!curve) throw new Error("There is no curve of the chosen yarn here.");
    this.choose(yarnIndex, this.register.addPoint(yarnIndex, curve.at, newLayer, Math.floor(curve.piece) + 1));
  },

  nudge(dx, dy) {
    const { look } = this, { work } = this.register;
    if (look.mode === "tile") {
      const tile = { ...work.tile, origin_px: [work.tile.origin_px[0] + dx, work.tile.origin_px[1] + dy] };
      this.register.setTile(tile, look.pointsStay);
    } else if (look.mode === "back") {
      this.register.setBack({ shift_px: [work.back.shift_px[0] + dx, work.back.shift_px[1] + dy] });
    } else if (this.point()) {
      const [x, y] = toPixel(work, this.point().at);
      this.register.movePoint(look.yarnIndex, look.pointIndex, fromPixel(work, [x + dx, y + dy]).map((v, k) => v * work.periods_m[k]));
    }
  },

  // The next of `count` things, around and around.
  next(index, by, count) { return index === null ? (by > 0 ? 0 : count - 1) : (index + by + count) % count; },

  key(event) {
    if (event.target.matches("input:not([type=range]):not([type=checkbox]), select, textarea") || $("help").open) return;
    const { look, register } = this, middle = [$("canvas").clientWidth / 2, $("canvas").clientHeight / 2];
    const key = event.key.length === 1 && !"{}[]".includes(event.key) ? event.key.toLowerCase() : event.key;
    const step = event.shiftKey ? 10 : 1, yarn = this.yarn();
    // Arrows on a slider and Enter or space on a button are theirs.
    if (event.target.matches("button, input") && (key.startsWith("Arrow") || key === "Enter")) return;
    const withControl = { z: () => event.shiftKey ? register.redo() : register.undo(), y: () => register.redo(), s: () => this.saveWork() };
    const points = by => yarn && yarn.points.length && this.choose(look.yarnIndex, this.next(look.pointIndex, by, yarn.points.length));
    const yarns = by => register.work.yarns.length && this.choose(this.next(look.yarnIndex, by, register.work.yarns.length), null);
    const crossing = () => {
      const { crossings } = register.drawn();
      if (!crossings.length) return;
      look.crossingIndex = this.next(look.crossingIndex, 1, crossings.length);
      this.goTo({ at: crossings[look.crossingIndex].at });
    };
    const alone = {
      n: () => this.newYarn(), Enter: () => this.isOpen() && this.closeYarn(), f: () => this.setLayer("front"), b: () => this.setLayer("back"), h: () => this.setLayer("hidden"),
      Delete: () => this.deletePoint(), Backspace: () => this.deletePoint(), "[": () => points(-1), "]": () => points(1), "{": () => yarns(-1), "}": () => yarns(1),
      ArrowLeft: () => this.nudge(-step, 0), ArrowRight: () => this.nudge(step, 0), ArrowUp: () => this.nudge(0, -step), ArrowDown: () => this.nudge(0, step),
      c: crossing, x: () => { const { crossingIndex } = look; if (crossingIndex !== null) { register.swap(crossingIndex); look.crossingIndex = crossingIndex; } },
      v: () => this.hasBack && this.setBlend(look.blend > 0.5 ? 0 : 1), 1: () => this.setMode("yarns"), 2: () => this.setMode("tile"), 3: () => this.hasBack && this.setMode("back"),
      0: () => this.fit(), "?": () => $("help").showModal(), Escape: () => this.choose(look.yarnIndex, null),
      "+": () => this.painter.zoom(1.25, middle), "=": () => this.painter.zoom(1.25, middle), "-": () => this.painter.zoom(0.8, middle),
    };
    const does = event.ctrlKey || event.metaKey ? withControl[key] : event.altKey ? null : alone[key];
    if (!does) return;
    event.preventDefault();
    this.attempt(does);
  },
});
