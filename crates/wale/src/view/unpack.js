"use strict";
// The page's numbers: base64 of a zlib stream. For each frame, for each of x, y, z and each quantity, differences along
// the yarn of differences in time, folded so that small ones of either sign are small (see pack.rs).

async function unpack(facts, text) {
  const packed = atob(text.trim());
  const bytes = new Uint8Array(packed.length);
  for (let i = 0; i < packed.length; ++i) bytes[i] = packed.charCodeAt(i);
  if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser cannot unpack the page's data (no DecompressionStream). Any browser of 2023 or later can.");
  }
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const raw = new Uint8Array(await new Response(stream).arrayBuffer());
  const points = facts.points, quantities = facts.quantities.length;
  const perFrame = points * (6 + quantities);
  if (raw.length !== perFrame * facts.frames.length) {
    throw new Error("The page's data is damaged: " + raw.length + " bytes instead of " + perFrame * facts.frames.length + ".");
  }
  const frames = [];
  let before = null;
  for (let f = 0; f < facts.frames.length; ++f) {
    let at = f * perFrame;
    const places = [];
    for (let axis = 0; axis < 3; ++axis) {
      const steps = new Uint16Array(points);   // differences along the yarn
      for (let i = 0; i < points; ++i) {
        const folded = raw[at + i] | (raw[at + points + i] << 8);
        const change = (folded >>> 1) ^ -(folded & 1);
        steps[i] = change + (before ? before.steps[axis][i] : 0);
      }
      at += 2 * points;
      const place = new Uint16Array(points);
      let sum = 0;
      for (let i = 0; i < points; ++i) place[i] = sum = (sum + steps[i]) & 0xffff;
      places.push({ steps, place });
    }
    const values = [];
    for (let q = 0; q < quantities; ++q) {
      const steps = new Uint8Array(points), value = new Uint8Array(points);
      let sum = 0;
      for (let i = 0; i < points; ++i) {
        const folded = raw[at + i];
        steps[i] = ((folded >>> 1) ^ -(folded & 1)) + (before ? before.valueSteps[q][i] : 0);
        value[i] = sum = (sum + steps[i]) & 0xff;
      }
      at += points;
      values.push({ steps, value });
    }
    before = { steps: places.map(p => p.steps), valueSteps: values.map(v => v.steps) };
    frames.push({ place: places.map(p => p.place), value: values.map(v => v.value) });
  }
  return frames;
}

// Unit normals along each yarn that do not spin about it (double reflection), as bytes; ply twist starts from them.
function unspunNormals(facts, frame, out) {
  const [X, Y, Z] = frame.place;
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = a => { const l = Math.hypot(a[0], a[1], a[2]) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };
  for (let c = 0; c + 1 < facts.start.length; ++c) {
    const first = facts.start[c], end = facts.start[c + 1];
    const chord = (i, j) => [X[j] - X[i], Y[j] - Y[i], Z[j] - Z[i]];
    const tangent = i => unit(chord(Math.max(i - 1, first), Math.min(i + 1, end - 1)));
    let t = tangent(first);
    let n = unit(cross(t, Math.abs(t[2]) < 0.8 ? [0, 0, 1] : [1, 0, 0]));
    for (let i = first; i < end; ++i) {
      const along = dot(n, t);
      n = unit([n[0] - along * t[0], n[1] - along * t[1], n[2] - along * t[2]]);
      for (let k = 0; k < 3; ++k) out[4 * i + k] = Math.round(127 * n[k]);
      if (i + 1 === end) break;
      const v = chord(i, i + 1), l = dot(v, v) || 1;
      const a = 2 * dot(v, n) / l, b = 2 * dot(v, t) / l;
      const m = [n[0] - a * v[0], n[1] - a * v[1], n[2] - a * v[2]];
      const u = [t[0] - b * v[0], t[1] - b * v[1], t[2] - b * v[2]];
      t = tangent(i + 1);
      const w = [t[0] - u[0], t[1] - u[1], t[2] - u[2]], k = dot(w, w);
      const d = k > 0 ? 2 * dot(w, m) / k : 0;
      n = [m[0] - d * w[0], m[1] - d * w[1], m[2] - d * w[2]];
    }
  }
}
