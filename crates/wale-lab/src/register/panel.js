// The panel beside the canvas: shows the work in words and numbers, and hands changes to the register.

const $ = id => document.getElementById(id);
// Slower solutions wait for a button, milliseconds.
const SLOW = 500;

class Panel {
  constructor(page) {
    this.page = page; this.register = page.register; this.lastSolve = 0;
    const { look } = page, again = () => page.redraw();
    for (const id of ["blend", "photo", "yarn"]) $(id).oninput = () => { look[id] = +$(id).value; again(); };
    $("style").onchange = () => { look.style = $("style").value; again(); };
    $("neighbours").onchange = () => { look.neighbours = +$("neighbours").value; again(); };
    $("show-crossings").onchange = () => { look.crossings = $("show-crossings").checked; again(); };
    $("rectangle").onchange = () => { look.rectangle = $("rectangle").checked; };
    $("lock-scale").onchange = () => { look.lockScale = $("lock-scale").checked; };
    $("points-stay").onchange = () => { look.pointsStay = $("points-stay").checked; };
    document.querySelectorAll("[data-mode]").forEach(b => b.onclick = () => page.setMode(b.dataset.mode));
    document.querySelectorAll("[data-layer]").forEach(b => b.onclick = () => page.setLayer(b.dataset.layer));
    const act = (id, does) => { $(id).onclick = () => page.attempt(does); };
    act("undo", () => this.register.undo());
    act("redo", () => this.register.redo());
    act("fit", () => page.fit());
    act("help-open", () => $("help").showModal());
    act("new-yarn", () => page.newYarn());
    act("close", () => page.closeYarn());
    act("reverse", () => this.register.reverse(look.yarnIndex));
    act("delete-point", () => page.deletePoint());
    act("save", () => page.saveWork());
    act("export", () => download(`${page.name}.pyp`, this.register.exportPattern(), "text/plain"));
    act("periods-from-scale", () => this.periodsFromScale());
    act("solve", () => { this.tell(true); page.redraw(); });
    $("load").onchange = async () => {
      const [file] = $("load").files;
      if (!file) return;
      const text = await file.text();
      page.attempt(() => { this.register.load(text); page.choose(0, null); });
      $("load").value = "";
    };
    this.numbers();
  }

  // Fields of numbers: each sets the work when it is left.
  numbers() {
    const field = (id, set) => { $(id).onchange = () => this.page.attempt(() => { set(+$(id).value); }); };
    const work = () => this.register.work;
    for (const k of [0, 1]) field(`period-${k}`, mm => this.register.setPeriods(work().periods_m.map((p, i) => i === k ? 1e-3 * mm : p)));
    field("radius", mm => this.register.setRadius(1e-3 * mm));
    field("spacing", radii => this.register.setSpacing(radii));
    field("turn", degrees => this.page.turnTile(degrees * Math.PI / 180));
    field("scale", micrometres => this.page.scaleTile(1e-6 * micrometres));
    const shift = () => work().back.shift_px;
    field("back-x", x => this.register.setBack({ shift_px: [x, shift()[1]] }));
    field("back-y", y => this.register.setBack({ shift_px: [shift()[0], y] }));
    field("back-turn", degrees => this.register.setBack({ turn_rad: degrees * Math.PI / 180 }));
    field("back-scale", factor => {
      if (!(factor > 0.01 && factor < 100)) throw new Error("The back photograph is larger by a factor of 0.01 to 100.");
      this.register.setBack({ scale: factor });
    });
    $("mirrored").onchange = () => this.register.setBack({ mirrored: $("mirrored").checked });
  }

  // Periods that the tile has on the photograph at the scale in the field.
  periodsFromScale() {
    const scale = 1e-6 * +$("scale").value, { along_px: u, across_px: v } = this.register.work.tile;
    if (!(scale > 0)) throw new Error("Give the scale of the photograph first, in micrometres a pixel.");
    this.register.setPeriods([scale * Math.hypot(...u), scale * Math.hypot(...v)]);
  }

  update(settled) {
    const { look } = this.page, { work } = this.register;
    document.querySelectorAll("[data-mode]").forEach(b => b.setAttribute("aria-checked", b.dataset.mode === look.mode));
    document.querySelectorAll("[data-only]").forEach(s => { s.hidden = s.dataset.only !== look.mode || "needsBack" in s.dataset && !this.page.hasBack; });
    const point = this.page.point(), layer = point ? point.layer : look.newLayer;
    document.querySelectorAll("[data-layer]").forEach(b => b.setAttribute("aria-checked", b.dataset.layer === layer));
    $("undo").disabled = !this.register.past.length;
    $("redo").disabled = !this.register.future.length;
    $("delete-point").disabled = !point;
    const yarn = work.yarns[look.yarnIndex];
    $("close").disabled = !yarn || !yarn.points.length;
    $("close").textContent = yarn && yarn.closes ? "Open it" : "Close it";
    $("reverse").disabled = !yarn;
    const put = (id, x, digits) => { if (document.activeElement !== $(id)) $(id).value = +x.toFixed(digits); };
    const [a, b] = scalesOf(work), { along_px: u } = work.tile;
    put("period-0", 1e3 * work.periods_m[0], 5);
    put("period-1", 1e3 * work.periods_m[1], 5);
    put("radius", 1e3 * work.radius_m, 5);
    put("spacing", work.spacing_radii, 2);
    put("turn", Math.atan2(-u[1], u[0]) * 180 / Math.PI, 2);
    put("scale", 1e6 * Math.sqrt(a * b), 4);
    $("scale-says").textContent = `${(1e6 * a).toFixed(3)} micrometres a pixel along the first period, ${(1e6 * b).toFixed(3)} along the second.`;
    put("back-x", work.back.shift_px[0], 2);
    put("back-y", work.back.shift_px[1], 2);
    put("back-turn", work.back.turn_rad * 180 / Math.PI, 3);
    put("back-scale", work.back.scale, 5);
    $("mirrored").checked = work.back.mirrored;
    if (!settled) return;
    this.listYarns();
    this.tell(this.lastSolve < SLOW);
  }

  listYarns() {
    const { look } = this.page, { work } = this.register, { lines } = this.register.drawn();
    // A field that is being typed in is not taken from under the hand.
    if ($("yarns").contains(document.activeElement) && document.activeElement.type === "text") return;
    $("yarns").replaceChildren(...work.yarns.map((yarn, y) => {
      const row = document.createElement("li");
      row.className = y === look.yarnIndex ? "chosen" : "";
      const input = (type, value, label, change) => {
        const field = Object.assign(document.createElement("input"), { type, value, title: label });
        field.setAttribute("aria-label", `${label} of ${yarn.name}`);
        field.onchange = () => this.page.attempt(() => change(field.value));
        row.append(field);
        return field;
      };
      input("color", yarn.color, "Colour", color => this.register.setColor(y, color));
      const name = input("text", yarn.name, "Name", text => this.register.renameYarn(y, text));
      name.onfocus = () => this.page.choose(y, null);
      for (const k of [0, 1]) {
        const field = input("number", yarn.closes ? yarn.closes[k] : "", `Closes so many ${k ? "second" : "first"} periods away`, text => {
          const closes = (yarn.closes || [0, 0]).slice();
          closes[k] = Math.round(+text);
          this.register.close(y, closes);
        });
        Object.assign(field, { min: -8, max: 8, step: 1, disabled: !yarn.points.length });
      }
      const remove = Object.assign(document.createElement("button"), { textContent: "×", title: `Delete ${yarn.name}` });
      remove.setAttribute("aria-label", `Delete ${yarn.name}`);
      remove.onclick = () => this.page.attempt(() => { this.register.removeYarn(y); this.page.choose(Math.max(0, y - 1), null); });
      row.append(remove);
      row.onclick = event => { if (event.target === row) this.page.choose(y, null); };
      return row;
    }));
    const yarn = work.yarns[look.yarnIndex], line = lines[look.yarnIndex];
    $("status").textContent = !yarn ? "No yarn yet. Click along one." :
      `${yarn.name}: ${yarn.points.length} points, ${millimetres(line.lengths[line.lengths.length - 1] || 0)} mm in the plane; ` +
      (yarn.closes ? `closes ${yarn.closes[0]} first and ${yarn.closes[1]} second periods away.` : "open: click on a dashed ring to close it.");
  }

  // Depths, and what is wrong.
  tell(compute) {
    $("solve").hidden = compute;
    this.page.look.solved = null;
    if (!compute) { $("depth").textContent = "This tile takes a while to solve."; return; }
    const began = performance.now(), tile = this.register.solve();
    this.lastSolve = performance.now() - began;
    const faults = tile.faults.map(f => ({ ...f, fault: true })), list = [...faults, ...tile.remarks];
    $("export").disabled = faults.length > 0;
    if (faults.length) $("depth").textContent = `No depths yet; ${faults.length} ${faults.length > 1 ? "things are" : "thing is"} missing:`;
    else {
      this.page.look.solved = tile;
      const count = tile.chains.reduce((sum, chain) => sum + chain.vertices.length, 0), all = tile.heights.flat();
      const thickness = 1e3 * (Math.max(...all) - Math.min(...all) + 2 * this.register.work.radius_m);
      $("depth").textContent = `${tile.crossings.length} crossings, ${count} vertices, fabric ${thickness.toFixed(3)} mm thick.`;
    }
    $("messages").replaceChildren(...list.slice(0, 30).map(message => {
      const row = document.createElement("li"), button = Object.assign(document.createElement("button"), { textContent: message.text });
      row.className = message.fault ? "fault" : "";
      button.onclick = () => this.page.goTo(message);
      row.append(button);
      return row;
    }));
    if (list.length > 30) $("messages").append(Object.assign(document.createElement("li"), { textContent: `and ${list.length - 30} more.` }));
  }
}

function download(name, text, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
