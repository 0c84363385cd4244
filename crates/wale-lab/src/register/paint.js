// What the canvas shows: photographs, tile, yarns and their images, control points, crossings. Reads the work, changes nothing.

const INK = "#23252b", PAPER = "#fff", ALARM = "#d3261b";

class Painter {
  constructor(canvas, photographs) {
    this.canvas = canvas; this.photographs = photographs;
    this.context = canvas.getContext("2d");
    this.view = { scale: 1, x: 0, y: 0 };
  }

  // Pixels of the front photograph to places on the screen, and back.
  toScreen([x, y]) { return [x * this.view.scale + this.view.x, y * this.view.scale + this.view.y]; }
  fromScreen([x, y]) { return [(x - this.view.x) / this.view.scale, (y - this.view.y) / this.view.scale]; }

  // Fits a box of pixels into the canvas.
  fit([low, high]) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const scale = Math.min(width / (high[0] - low[0]), height / (high[1] - low[1])) * 0.94;
    this.view = { scale, x: (width - scale * (low[0] + high[0])) / 2, y: (height - scale * (low[1] + high[1])) / 2 };
  }

  zoom(factor, [x, y]) {
    const scale = Math.min(Math.max(this.view.scale * factor, 0.005), 200), by = scale / this.view.scale;
    this.view = { scale, x: x - (x - this.view.x) * by, y: y - (y - this.view.y) * by };
  }

  draw(register, look) {
    const { canvas, context: c } = this, ratio = window.devicePixelRatio || 1;
    const size = [canvas.clientWidth, canvas.clientHeight].map(x => Math.max(1, Math.round(x * ratio)));
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.fillStyle = "#77797d";
    c.fillRect(0, 0, canvas.clientWidth, canvas.clientHeight);
    this.photos(register.work, look);
    const drawn = register.drawn(), images = this.images(look.neighbours);
    if (look.style === "yarns" && look.solved) this.bodies(register.work, drawn, look, images);
    else this.bands(register.work, drawn, look, images);
    this.tile(register.work, look);
    if (look.crossings) this.crossings(register.work, drawn, look, images);
    this.points(register.work, look);
  }

  images(reach) {
    const images = [];
    for (let i = -reach; i <= reach; i++) for (let j = -reach; j <= reach; j++) images.push([i, j]);
    // The tile itself last, over its images.
    return images.filter(k => k[0] || k[1]).concat([[0, 0]]);
  }

  photos(work, look) {
    const c = this.context, { front, back } = this.photographs;
    c.save();
    c.translate(this.view.x, this.view.y);
    c.scale(this.view.scale, this.view.scale);
    c.fillStyle = PAPER;
    c.fillRect(0, 0, front.naturalWidth, front.naturalHeight);
    c.globalAlpha = look.photo;
    c.drawImage(front, 0, 0);
    if (back && look.blend > 0) {
      const { mirrored, shift_px: shift, turn_rad: turn, scale } = work.back;
      c.globalAlpha = look.photo * look.blend;
      c.translate(front.naturalWidth / 2 + shift[0], front.naturalHeight / 2 + shift[1]);
      c.rotate(turn);
      c.scale(mirrored ? -scale : scale, scale);
      c.drawImage(back, -back.naturalWidth / 2, -back.naturalHeight / 2);
    }
    c.restore();
  }

  path(places, closed) {
    const c = this.context;
    c.beginPath();
    places.forEach(([x, y], i) => i ? c.lineTo(x, y) : c.moveTo(x, y));
    if (closed) c.closePath();
  }

  // A part of the periods on the screen.
  part(work, at) { return this.toScreen(toPixel(work, at)); }
  metres(work, at, shift = [0, 0]) { return this.part(work, at.map((x, k) => x / work.periods_m[k] + shift[k])); }

  tile(work, look) {
    const c = this.context, corner = (a, b) => this.part(work, [a, b]), reach = look.neighbours;
    c.lineWidth = 1;
    c.strokeStyle = "rgba(255,255,255,.55)";
    c.setLineDash([3, 4]);
    for (let i = -reach; i <= reach + 1; i++) {
      for (const line of [[corner(i, -reach), corner(i, reach + 1)], [corner(-reach, i), corner(reach + 1, i)]]) { this.path(line); c.stroke(); }
    }
    c.setLineDash([]);
    const outline = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
    for (const [width, color] of [[4, "rgba(255,255,255,.9)"], [2, INK]]) {
      c.lineWidth = width; c.strokeStyle = color;
      this.path(outline, true); c.stroke();
    }
    if (look.mode !== "tile") return;
    outline.forEach(([x, y], i) => {
      c.fillStyle = i ? PAPER : "#ffd34d"; c.strokeStyle = INK; c.lineWidth = 2;
      c.beginPath(); c.rect(x - 6, y - 6, 12, 12); c.fill(); c.stroke();
    });
  }

  // Yarns as translucent bands of their width, with centrelines.
  bands(work, drawn, look, images) {
    const c = this.context, perMetre = this.view.scale / Math.sqrt(scalesOf(work)[0] * scalesOf(work)[1]);
    c.lineJoin = "round";
    for (const image of images) {
      const own = !image[0] && !image[1];
      drawn.lines.forEach((line, y) => {
        if (line.places.length < 2) return;
        this.path(line.places.map(at => this.metres(work, at, image)));
        c.strokeStyle = work.yarns[y].color;
        if (look.style !== "lines") {
          c.globalAlpha = look.yarn * (own ? 0.38 : 0.2);
          c.lineCap = "butt"; c.lineWidth = 2 * work.radius_m * perMetre;
          c.stroke();
        }
        c.globalAlpha = own ? 1 : 0.65; c.lineCap = "round";
        if (own) { c.lineWidth = y === look.yarnIndex ? 4.5 : 3.5; c.strokeStyle = "rgba(255,255,255,.8)"; c.stroke(); c.strokeStyle = work.yarns[y].color; }
        c.lineWidth = y === look.yarnIndex ? 2.5 : 1.6;
        c.stroke();
        c.globalAlpha = 1;
      });
    }
  }

  // Yarns as they lie over each other: short pieces from the lowest to the highest, each with its sides in ink. They are drawn
  // apart and laid over the photograph as one, so that what is hidden does not shine through.
  bodies(work, drawn, look, images) {
    const layer = document.createElement("canvas"), own = this.context, { chains, heights } = look.solved;
    Object.assign(layer, { width: this.canvas.width, height: this.canvas.height });
    const c = layer.getContext("2d");
    c.setTransform(own.getTransform());
    const width = 2 * work.radius_m * this.view.scale / Math.sqrt(scalesOf(work)[0] * scalesOf(work)[1]);
    const highest = Math.max(...heights.flat().map(Math.abs), 1e-12), side = look.blend > 0.5 ? -1 : 1, pieces = [];
    drawn.lines.forEach((line, y) => {
      const n = line.places.length - 1, jump = chains[y].jump;
      // Places before the first and after the last are images of others.
      const place = i => i < 0 || i > n ? line.places[(i + n) % n].map((x, k) => x + Math.sign(i) * jump[k]) : line.places[i];
      for (let i = 0, e = 0; i < n; i++) {
        while (e + 1 < chains[y].lengths.length && chains[y].lengths[e + 1] <= line.lengths[i]) e++;
        const from = chains[y].lengths[e], to = chains[y].lengths[e + 1] ?? chains[y].planLength;
        const t = Math.min((line.lengths[i] - from) / (to - from), 1), low = heights[y][e], high = heights[y][(e + 1) % heights[y].length];
        pieces.push({ color: work.yarns[y].color, z: low + t * (high - low), places: [-2, -1, 0, 1, 2, 3].map(k => place(i + k)) });
      }
    });
    pieces.sort((a, b) => side * (a.z - b.z));
    const stroke = (places, color, thick) => {
      c.beginPath();
      places.forEach(([x, y], i) => i ? c.lineTo(x, y) : c.moveTo(x, y));
      Object.assign(c, { lineWidth: thick, strokeStyle: color, lineJoin: "round" });
      c.stroke();
    };
    for (const { places, color, z } of pieces) for (const image of images) {
      const seen = places.map(at => this.metres(work, at, image));
      // Colour reaches a little farther than ink, whose ends would show as lines across the yarn.
      stroke(seen.slice(1, 5), INK, width);
      stroke(seen, shaded(color, side * z / highest), Math.max(width - 3, 1));
    }
    own.save();
    own.setTransform(1, 0, 0, 1, 0, 0);
    own.globalAlpha = look.yarn;
    own.drawImage(layer, 0, 0);
    own.restore();
  }

  points(work, look) {
    const c = this.context;
    work.yarns.forEach((yarn, y) => {
      const chosen = y === look.yarnIndex;
      yarn.points.forEach((point, p) => {
        const [x, q] = this.part(work, point.at), picked = chosen && p === look.pointIndex, r = picked ? 8 : chosen ? 6 : 4.5;
        c.beginPath();
        // Front: a full disc; back: a ring; hidden: a small square on its corner.
        if (point.layer === "hidden") { c.moveTo(x, q - r); c.lineTo(x + r, q); c.lineTo(x, q + r); c.lineTo(x - r, q); c.closePath(); }
        else c.arc(x, q, r, 0, 2 * Math.PI);
        c.fillStyle = point.layer === "front" ? yarn.color : PAPER;
        c.fill();
        c.lineWidth = picked ? 3.5 : 2.2;
        c.strokeStyle = picked ? INK : point.layer === "front" ? PAPER : yarn.color;
        c.stroke();
      });
      if (!chosen || yarn.closes || !yarn.points.length) return;
      // Where a yarn that is still open can go on to: images of its first point.
      for (const image of this.images(1)) {
        if (!image[0] && !image[1]) continue;
        const [x, q] = this.part(work, yarn.points[0].at.map((v, k) => v + image[k]));
        c.beginPath(); c.arc(x, q, 9, 0, 2 * Math.PI);
        c.lineWidth = 2; c.strokeStyle = yarn.color; c.setLineDash([3, 3]); c.stroke(); c.setLineDash([]);
      }
    });
  }

  crossings(work, drawn, look, images) {
    const c = this.context;
    for (const image of images) drawn.crossings.forEach((crossing, index) => {
      const [x, y] = this.metres(work, crossing.at, image), own = !image[0] && !image[1];
      const unknown = crossing.over === null, r = unknown ? 8 : index === look.crossingIndex ? 7 : 4;
      c.globalAlpha = own || unknown ? 1 : 0.5;
      c.beginPath(); c.arc(x, y, r, 0, 2 * Math.PI);
      c.fillStyle = unknown ? ALARM : work.yarns[crossing.ends[crossing.over][0]].color;
      c.fill();
      c.lineWidth = index === look.crossingIndex && own ? 3 : 1.5;
      c.strokeStyle = crossing.why === "click" ? INK : PAPER;
      c.stroke();
      if (unknown) {
        c.fillStyle = PAPER; c.font = "bold 12px system-ui, sans-serif"; c.textAlign = "center"; c.textBaseline = "middle";
        c.fillText("?", x, y + 0.5);
      }
      c.globalAlpha = 1;
    });
  }
}

// A colour nearer to white in front and to black at the back; `depth` from -1 to 1.
function shaded(color, depth) {
  const toward = depth > 0 ? 255 : 0, part = depth > 0 ? 0.35 * depth : -0.45 * depth;
  const channels = [1, 3, 5].map(i => parseInt(color.slice(i, i + 2), 16)).map(v => Math.round(v + part * (toward - v)));
  return `rgb(${channels})`;
}
