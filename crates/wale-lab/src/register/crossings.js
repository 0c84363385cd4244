// Where yarns and their periodic images cross in the plane, which is above, and where they come too near in space.
//
// A drawn yarn is { vertices: [[x, y], ...], jump: [x, y] or null, closes, pieces }: a chain that leads on to its own first
// vertex moved by `jump` if it is closed.

function edgeOf(yarn, e) {
  const a = yarn.vertices[e], next = yarn.vertices[e + 1];
  return [a, next || [yarn.vertices[0][0] + yarn.jump[0], yarn.vertices[0][1] + yarn.jump[1]]];
}

function edgeCount(yarn) {
  return yarn.jump ? yarn.vertices.length : Math.max(yarn.vertices.length - 1, 0);
}

// Calls `visit(a, b, shift)` once for every pair of edges whose boxes come nearer than `margin`; a and b are [yarn, edge], and b
// is looked at in the tile `shift` periods away. Edges are sorted into cells of the tile; one that reaches over its border
// remembers in which tile it lies.
function visitNearEdges(yarns, periods, margin, visit) {
  let longest = 0, total = 0;
  yarns.forEach(yarn => {
    for (let e = 0; e < edgeCount(yarn); e++, total++) {
      const [a, b] = edgeOf(yarn, e);
      longest = Math.max(longest, Math.abs(b[0] - a[0]), Math.abs(b[1] - a[1]));
    }
  });
  const side = Math.max(longest + margin, 1e-12);
  const counts = periods.map(p => Math.min(Math.max(1, Math.floor(p / side)), 400));
  const cells = new Map(), boxes = [];
  yarns.forEach((yarn, y) => {
    for (let e = 0; e < edgeCount(yarn); e++) {
      const [a, b] = edgeOf(yarn, e), index = boxes.length;
      const low = [0, 1].map(k => Math.min(a[k], b[k]) - margin / 2), high = [0, 1].map(k => Math.max(a[k], b[k]) + margin / 2);
      boxes.push({ id: [y, e], low, high });
      const range = [0, 1].map(k => [low[k], high[k]].map(x => Math.floor(x / periods[k] * counts[k])));
      for (let i = range[0][0]; i <= range[0][1]; i++) {
        for (let j = range[1][0]; j <= range[1][1]; j++) {
          const tile = [Math.floor(i / counts[0]), Math.floor(j / counts[1])];
          const cell = (i - tile[0] * counts[0]) * counts[1] + j - tile[1] * counts[1];
          if (!cells.has(cell)) cells.set(cell, []);
          cells.get(cell).push({ index, tile });
        }
      }
    }
  });
  const seen = new Set();
  for (const entries of cells.values()) {
    for (const a of entries) for (const b of entries) {
      if (a.index >= b.index) continue;
      const shift = [a.tile[0] - b.tile[0], a.tile[1] - b.tile[1]];
      const key = `${a.index} ${b.index} ${shift}`;
      if (seen.has(key)) continue;
      seen.add(key);
      const [p, q] = [boxes[a.index], boxes[b.index]];
      const apart = [0, 1].some(k => q.low[k] + shift[k] * periods[k] > p.high[k] || q.high[k] + shift[k] * periods[k] < p.low[k]);
      if (!apart) visit(p.id, q.id, shift);
    }
  }
}

// Edges of one yarn that share a vertex, over its closing too.
function areNeighbours(yarns, a, b, shift) {
  if (a[0] !== b[0]) return false;
  const yarn = yarns[a[0]], n = yarn.vertices.length, same = (x, y) => x[0] === y[0] && x[1] === y[1];
  if (same(shift, [0, 0])) return b[1] - a[1] === 1;
  return !!yarn.jump && a[1] === 0 && b[1] === n - 1 && same(shift, yarn.closes.map(k => -k));
}

// All crossings: { ends: [[yarn, edge, part], [yarn, edge, part]], shift, at }, the place on the first yarn's own curve.
// A crossing at a vertex is found on either edge there, on both, or by rounding on none: so ends count with a margin, and what
// is found twice is kept once.
const AT_THE_END = 1e-9;
function findCrossings(yarns, periods) {
  const found = [], atEnds = [];
  visitNearEdges(yarns, periods, AT_THE_END * Math.min(...periods), (a, b, shift) => {
    if (areNeighbours(yarns, a, b, shift)) return;
    const [p, q] = edgeOf(yarns[a[0]], a[1]), [r, s] = edgeOf(yarns[b[0]], b[1]);
    const move = [shift[0] * periods[0], shift[1] * periods[1]];
    const d = [q[0] - p[0], q[1] - p[1]], e = [s[0] - r[0], s[1] - r[1]], f = [r[0] + move[0] - p[0], r[1] + move[1] - p[1]];
    const turn = d[0] * e[1] - d[1] * e[0], size = Math.hypot(...d);
    if (Math.abs(turn) < 1e-9 * size * Math.hypot(...e)) return;
    const parts = [(f[0] * e[1] - f[1] * e[0]) / turn, (f[0] * d[1] - f[1] * d[0]) / turn];
    if (parts.some(x => x < -AT_THE_END || x > 1 + AT_THE_END)) return;
    const [t, u] = parts.map(x => Math.min(Math.max(x, 0), 1));
    const crossing = { ends: [[...a, t], [...b, u]], shift, at: [p[0] + t * d[0], p[1] + t * d[1]] };
    if (parts.some(x => x < AT_THE_END || x > 1 - AT_THE_END)) {
      if (atEnds.some(other => isSame(other, crossing, yarns, periods, 1e-6 * size))) return;
      atEnds.push(crossing);
    }
    found.push(crossing);
  });
  return found.sort((a, b) => a.ends[0][0] - b.ends[0][0] || a.ends[0][1] + a.ends[0][2] - b.ends[0][1] - b.ends[0][2]);
}

// Whether two crossings are one place of the same two strands, found on edges beside each other.
function isSame(c, d, yarns, periods, near) {
  const beside = (a, b) => {
    const n = yarns[a[0]].vertices.length, apart = Math.abs(a[1] - b[1]);
    return a[0] === b[0] && (apart <= 1 || apart >= n - 1);
  };
  const [a, b] = c.ends, [e, f] = d.ends;
  return (beside(a, e) && beside(b, f) || beside(a, f) && beside(b, e)) && periodicDistance(c.at, d.at, periods) < near;
}

// How far to the front a yarn is at a place: marks are 1 in front, -1 at the back and 0 for hidden, and go over into each other.
const MARKS = { front: 1, back: -1, hidden: 0 };
function markAt(points, piece) {
  const n = points.length, i = Math.floor(piece), t = piece - i;
  return (1 - t) * MARKS[points[i % n].layer] + t * MARKS[points[(i + 1) % n].layer];
}

function pieceAt(yarn, [, edge, part], pointCount) {
  const next = edge + 1 < yarn.pieces.length ? yarn.pieces[edge + 1] : pointCount;
  return yarn.pieces[edge] + part * (next - yarn.pieces[edge]);
}

// Distance of two places of the tile, whatever tile they lie in [m].
function periodicDistance(a, b, periods) {
  return Math.hypot(...[0, 1].map(k => {
    const d = a[k] - b[k];
    return d - periods[k] * Math.round(d / periods[k]);
  }));
}

// Says of every crossing which end is over (0 or 1, null if unknown) and why: "click", "marks" or "none". `orders` are decisions
// by hand, { over, under, at }: one belongs to the nearest crossing of the same two yarns, if that is within four radii.
// Marks that differ by less give no order.
const LEAST_DIFFERENCE = 0.1;
function orderCrossings(crossings, yarns, points, orders, periods, radius) {
  const named = crossings.map(crossing => {
    const marks = crossing.ends.map(end => markAt(points[end[0]], pieceAt(yarns[end[0]], end, points[end[0]].length)));
    const difference = marks[0] - marks[1];
    const known = Math.abs(difference) > LEAST_DIFFERENCE;
    return { ...crossing, marks, over: known ? (difference > 0 ? 0 : 1) : null, why: known ? "marks" : "none" };
  });
  const choices = [];
  orders.forEach((order, o) => named.forEach((crossing, c) => {
    const [a, b] = crossing.ends.map(end => end[0]);
    if (!(a === order.over && b === order.under || a === order.under && b === order.over)) return;
    const distance = periodicDistance(order.at, crossing.at, periods);
    if (distance < 4 * radius) choices.push({ distance, o, c });
  }));
  choices.sort((a, b) => a.distance - b.distance);
  const used = new Set();
  for (const { o, c } of choices) {
    const crossing = named[c], order = orders[o];
    if (used.has(o) || crossing.why === "click") continue;
    used.add(o);
    // A yarn that crosses an image of itself: the decision names the end by its direction in the list.
    const own = crossing.ends[0][0] === crossing.ends[1][0];
    crossing.over = own ? order.end : crossing.ends[0][0] === order.over ? 0 : 1;
    crossing.why = "click";
    crossing.order = o;
  }
  return named;
}

// Least distance of two straight pieces in space.
function pieceDistance(p, q, r, s) {
  const sub = (a, b) => a.map((x, k) => x - b[k]), dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
  const clamp = x => Math.min(Math.max(x, 0), 1);
  const d = sub(q, p), e = sub(s, r), f = sub(p, r);
  const a = dot(d, d), b = dot(d, e), c = dot(e, e), g = dot(d, f), h = dot(e, f), below = a * c - b * b;
  let t = below > 1e-12 * a * c ? clamp((b * h - c * g) / below) : 0;
  const u = clamp((b * t + h) / c);
  t = clamp((b * u - g) / a);
  return Math.hypot(...p.map((x, k) => x + t * d[k] - r[k] - u * e[k]));
}

// The deepest place of every two yarns that come nearer than `reach`: { yarns, shift, at, distance }. Edges of one yarn with
// less than half a circle of yarn between them bend round together and are passed over.
function nearestPlaces(yarns, heights, periods, radius, reach) {
  const deepest = new Map();
  const lengths = yarns.map(yarn => yarn.vertices.length ? yarn.planLength / edgeCount(yarn) : 0);
  visitNearEdges(yarns, periods, reach, (a, b, shift) => {
    if (a[0] === b[0] && besideItself(yarns[a[0]], a[1], b[1], shift) * lengths[a[0]] < Math.PI * radius) return;
    const lift = (id, move) => edgeOf(yarns[id[0]], id[1]).map((x, k) => {
      const z = heights[id[0]];
      return [x[0] + move[0] * periods[0], x[1] + move[1] * periods[1], z[(id[1] + k) % z.length]];
    });
    const [[p, q], [r, s]] = [lift(a, [0, 0]), lift(b, shift)];
    const distance = pieceDistance(p, q, r, s);
    if (distance >= reach) return;
    const key = `${a[0]} ${b[0]} ${shift}`;
    if (!deepest.has(key) || deepest.get(key).distance > distance) deepest.set(key, { yarns: [a[0], b[0]], shift, at: p.slice(0, 2), distance });
  });
  return [...deepest.values()].sort((a, b) => a.distance - b.distance);
}

// Number of edges from one edge of a yarn to another one's image along the yarn; infinite where that is another strand of it.
function besideItself(yarn, a, b, shift) {
  const n = edgeCount(yarn), closes = yarn.closes || [0, 0];
  for (const turns of [-1, 0, 1]) {
    if (shift[0] === turns * closes[0] && shift[1] === turns * closes[1]) return Math.abs(b + turns * n - a);
  }
  return Infinity;
}
