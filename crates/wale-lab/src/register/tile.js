// From the work to a tile of yarns in space: sampled curves, crossings with their order, heights, faults, and the file.

const MOST_VERTICES = 20000;
// Centrelines nearer than so many radii are mentioned; yarns that just touch are two apart.
const TOO_NEAR = 1.8, THROUGH = 1;

function millimetres(x) { return (1e3 * x).toFixed(3); }
function placeText(at, periods) {
  const inside = at.map((x, k) => x - periods[k] * Math.floor(x / periods[k]));
  return `(${inside.map(millimetres).join(", ")}) mm`;
}

// The spline of a yarn in metres, and its fine polyline.
function lineOf(work, yarn) {
  const points = yarn.points.map(point => point.at.map((x, k) => x * work.periods_m[k]));
  const jump = yarn.closes && points.length ? yarn.closes.map((x, k) => x * work.periods_m[k]) : null;
  const spline = splineThrough(points, jump);
  // A polyline several times finer than the vertices that are taken from it.
  const longest = Math.max(0, ...spline.steps.map(step => step * step));
  return splinePolyline(spline, Math.min(Math.max(16, Math.ceil(5 * longest / (work.spacing_radii * work.radius_m))), 400));
}

// A yarn as a chain of vertices at rising lengths of its polyline.
function chainOf(work, yarn, line, lengths) {
  const places = placesAt(line, lengths), jump = yarn.closes ? yarn.closes.map((x, k) => x * work.periods_m[k]) : null;
  return {
    vertices: places.map(p => p.at), pieces: places.map(p => p.piece), lengths, jump, closes: yarn.closes,
    planLength: line.lengths[line.lengths.length - 1],
  };
}

function evenLengths(total, spacing, closed) {
  // One more than is allowed is enough to be told of, however far away a point was put.
  const count = Math.min(Math.max(Math.round(total / spacing), 4), MOST_VERTICES + 1);
  return Array.from({ length: closed ? count : count + 1 }, (_, i) => i * total / count);
}

// All yarns, evenly sampled in the plane, with their crossings as far as they are known; what the page draws.
function drawnTile(work) {
  const lines = work.yarns.map(yarn => lineOf(work, yarn)), spacing = work.spacing_radii * work.radius_m;
  const chains = work.yarns.map((yarn, y) => {
    const total = lines[y].lengths[lines[y].lengths.length - 1] || 0;
    return chainOf(work, yarn, lines[y], total > 0 ? evenLengths(total, spacing, !!yarn.closes) : []);
  });
  const faults = faultsOfYarns(work, chains);
  if (chains.reduce((sum, chain) => sum + chain.vertices.length, 0) > MOST_VERTICES) {
    faults.push({ kind: "size", text: `The yarns need more than ${MOST_VERTICES} vertices: is the radius right, and is the tile a small repeat?` });
    return { lines, chains, crossings: [], faults };
  }
  const crossings = crossingsOf(work, chains);
  for (const crossing of crossings.filter(c => c.over === null)) {
    const [a, b] = crossing.ends.map(end => work.yarns[end[0]].name);
    faults.push({ kind: "order", at: crossing.at, text: `${a} and ${b} cross at ${placeText(crossing.at, work.periods_m)} without an order: ` +
      "mark points beside the crossing as front, back or hidden, or click on it." });
  }
  return { lines, chains, crossings, faults };
}

function crossingsOf(work, chains) {
  const points = work.yarns.map(yarn => yarn.points);
  return orderCrossings(findCrossings(chains, work.periods_m), chains, points, work.orders, work.periods_m, work.radius_m);
}

function faultsOfYarns(work, chains) {
  const faults = [], say = (yarn, text) => faults.push({ kind: "yarn", yarn, text });
  if (!work.yarns.length) say(null, "There is no yarn yet: click on the photograph along one.");
  work.yarns.forEach((yarn, y) => {
    if (!yarn.points.length) say(y, `${yarn.name} has no points.`);
    else if (!yarn.closes) say(y, `${yarn.name} does not close: its last point must lead on to the image of its first one in another tile.`);
    else if (!yarn.closes[0] && !yarn.closes[1]) say(y, `${yarn.name} closes on itself within the tile: a ring holds to nothing across the period.`);
    else if (!chains[y].vertices.length) say(y, `${yarn.name} has no length.`);
  });
  return faults;
}

// Heights, and vertices that lie evenly along the yarns in space. Three rounds settle how many there are and where.
function solvedTile(work) {
  const drawn = drawnTile(work);
  if (drawn.faults.length) return { faults: drawn.faults, remarks: [] };
  const radius = work.radius_m, spacing = work.spacing_radii * radius;
  let chains = drawn.chains, crossings = drawn.crossings, depths;
  try {
    for (let round = 0; ; round++) {
      depths = depthsOf(chains, crossings, radius);
      if (round === 3) break;
      chains = chains.map((chain, y) => {
        const steps = edgesInSpace(chain, depths.heights[y]);
        const sums = [0];
        for (const step of steps) sums.push(sums[sums.length - 1] + step);
        let i = 1;
        const lengths = evenLengths(sums[sums.length - 1], spacing, true).map(s => {
          while (i < sums.length - 1 && sums[i] < s) i++;
          const from = chain.lengths[i - 1], to = i < chain.lengths.length ? chain.lengths[i] : chain.planLength;
          return from + (to - from) * (s - sums[i - 1]) / (sums[i] - sums[i - 1]);
        });
        return chainOf(work, work.yarns[y], drawn.lines[y], lengths);
      });
      crossings = crossingsOf(work, chains);
    }
  } catch (error) {
    return { faults: [{ kind: "depth", text: error.message }], remarks: [] };
  }
  crossings.forEach((crossing, c) => { crossing.gap = depths.gaps[c] * radius; });
  const tile = { faults: [], chains, heights: depths.heights, crossings };
  tile.remarks = remarksOf(work, tile);
  return tile;
}

function depthsOf(chains, crossings, radius) {
  const steps = chains.map(chain => chain.vertices.map((_, e) => {
    const [a, b] = edgeOf(chain, e);
    return Math.max(Math.hypot(b[0] - a[0], b[1] - a[1]) / radius, 1e-3);
  }));
  const { heights, gaps } = solveDepths(steps, crossings.map(({ ends, over }) => ({ over: ends[over], under: ends[1 - over] })));
  return { heights: heights.map(list => Array.from(list, z => z * radius)), gaps };
}

function edgesInSpace(chain, heights) {
  return chain.vertices.map((_, e) => {
    const [a, b] = edgeOf(chain, e);
    return Math.hypot(b[0] - a[0], b[1] - a[1], heights[(e + 1) % heights.length] - heights[e]);
  });
}

// What is odd about a tile that can be written all the same.
function remarksOf(work, { chains, heights, crossings }) {
  const radius = work.radius_m, remarks = [];
  const name = y => work.yarns[y].name;
  for (const near of nearestPlaces(chains, heights, work.periods_m, radius, TOO_NEAR * radius)) {
    const ratio = near.distance / radius;
    const how = ratio < THROUGH ? "run into each other" : "sink into each other";
    const who = near.yarns[0] === near.yarns[1] ? `${name(near.yarns[0])} and an image of it` : near.yarns.map(name).join(" and ");
    remarks.push({ kind: "near", at: near.at, ratio, text: `${who} ${how} at ${placeText(near.at, work.periods_m)}: ` +
      `centrelines ${ratio.toFixed(2)} radii apart, where two touch.` });
  }
  const wide = crossings.filter(c => c.gap > 2.2 * radius).length;
  if (wide) remarks.push({ kind: "wide", text: `${wide} of ${crossings.length} crossings are held farther apart than two radii by others.` });
  const highest = Math.max(...heights.map(list => Math.max(...list.map(Math.abs)))) / radius;
  if (highest > 8) remarks.push({ kind: "high", text: `Yarns reach ${highest.toFixed(1)} radii from the middle: are all crossings in the right order?` });
  const [a, b] = scalesOf(work);
  if (Math.abs(a / b - 1) > 0.03) {
    remarks.push({ kind: "scale", text: `The photograph has ${(1e6 * a).toFixed(2)} micrometres a pixel along the first period and ` +
      `${(1e6 * b).toFixed(2)} along the second: is the tile in its place, and are the periods right?` });
  }
  return remarks;
}

// The tile as a .pyp file: metres, at rest as it lies. Vertices lie within the tile; edges say where they leave it.
function patternText(work, tile) {
  const lines = { Q: [], E: [], RL: [], RK: [] }, periods = work.periods_m;
  const count = tile.chains.reduce((sum, chain) => sum + chain.vertices.length, 0);
  const mean = tile.heights.flat().reduce((sum, z) => sum + z, 0) / count;
  const text = x => (x === 0 ? 0 : x).toExponential();
  tile.chains.forEach((chain, y) => {
    const n = chain.vertices.length, first = lines.Q.length, heights = tile.heights[y];
    const tiles = chain.vertices.map(v => v.map((x, k) => Math.floor(x / periods[k])));
    const lengths = edgesInSpace(chain, heights);
    const edge = e => {
      const [a, b] = edgeOf(chain, e);
      return [b[0] - a[0], b[1] - a[1], heights[(e + 1) % n] - heights[e]];
    };
    chain.vertices.forEach((v, i) => {
      const next = (i + 1) % n, over = i + 1 === n ? chain.closes : [0, 0];
      lines.Q.push([...v.map((x, k) => text(x - tiles[i][k] * periods[k])), text(heights[i] - mean)].join(" "));
      lines.E.push([first + i, first + next, ...[0, 1].map(k => tiles[next][k] + over[k] - tiles[i][k])].join(" "));
      lines.RL.push(text(lengths[i]));
      const e = edge((i + n - 1) % n), f = edge(i);
      const across = Math.hypot(e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]);
      const along = e[0] * f[0] + e[1] * f[1] + e[2] * f[2];
      lines.RK.push(`${text(2 * across / (lengths[(i + n - 1) % n] * lengths[i] + along))} 0e+0`);
    });
  });
  return [
    "*pattern # px py radius vertices", `${periods.map(text).join(" ")} ${text(work.radius_m)} ${count}`, "",
    "*Q # x y z", ...lines.Q, "", "*E # first last dx dy", ...lines.E, "",
    "*RL # rest length of the edge that begins at each vertex", ...lines.RL, "", "*RK # rest curvature; without a section RT yarns are as wound as they lie", ...lines.RK, "",
  ].join("\n");
}
