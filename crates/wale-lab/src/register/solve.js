// Depths: the smoothest heights along the yarns that keep every crossing two radii apart. Lengths are in yarn radii.
//
//   least  1/2 sum over vertices of  [ (z[i+1] - z[i]) / h[i]  -  (z[i] - z[i-1]) / h[i-1] ]^2 / H[i]  +  1/2 w sum H[i] z[i]^2
//   with   z(over) - z(under) >= 2  at every crossing,
//
// h the lengths of edges in the plane, H[i] the mean of those beside vertex i, z at a crossing linear along its edges. The
// small weight w draws what nothing holds to the middle plane; without it two yarns that only lie on each other would have no
// place. Shifting all heights changes neither the first sum nor the gaps, so that w also makes their mean zero.

const TO_THE_MIDDLE = 1e-6;
const CONTRADICTION = "No heights fit all crossings: look for two that lie on one place and contradict each other.";

// The matrix of one closed yarn, factored. Vertices are taken from both ends of the list in turn, so that neighbours around
// the closed chain are at most four places apart: a band of four.
const BAND = 4;
function factorYarn(steps) {
  const n = steps.length, order = [], place = new Array(n);
  for (let k = 0; k < n; k++) order.push(k % 2 ? n - (k + 1) / 2 : k / 2);
  order.forEach((vertex, k) => { place[vertex] = k; });
  const lower = Array.from({ length: n }, () => new Float64Array(BAND + 1));
  const add = (a, b, value) => {
    const [i, j] = [Math.max(place[a], place[b]), Math.min(place[a], place[b])];
    lower[i][i - j] += value;
  };
  for (let i = 0; i < n; i++) {
    const before = (i + n - 1) % n, after = (i + 1) % n, mean = 0.5 * (steps[before] + steps[i]);
    const row = [[before, 1 / steps[before]], [i, -1 / steps[before] - 1 / steps[i]], [after, 1 / steps[i]]];
    for (const [a, x] of row) for (const [b, y] of row) if (place[a] > place[b] || a === b) add(a, b, x * y / mean);
    add(i, i, TO_THE_MIDDLE * mean);
  }
  for (let i = 0; i < n; i++) {
    for (let d = Math.min(BAND, i); d >= 0; d--) {
      let sum = lower[i][d];
      const j = i - d;
      for (let k = Math.max(0, i - BAND, j - BAND); k < j; k++) sum -= lower[i][i - k] * lower[j][j - k];
      lower[i][d] = d ? sum / lower[j][0] : Math.sqrt(sum);
    }
  }
  return { order, lower };
}

function solveYarn({ order, lower }, right) {
  const n = order.length, x = Float64Array.from(order, vertex => right[vertex]);
  for (let i = 0; i < n; i++) {
    for (let k = Math.max(0, i - BAND); k < i; k++) x[i] -= lower[i][i - k] * x[k];
    x[i] /= lower[i][0];
  }
  for (let i = n - 1; i >= 0; i--) {
    for (let k = i + 1; k < Math.min(n, i + BAND + 1); k++) x[i] -= lower[k][k - i] * x[k];
    x[i] /= lower[i][0];
  }
  const solution = new Float64Array(n);
  order.forEach((vertex, k) => { solution[vertex] = x[k]; });
  return solution;
}

// Solves a dense symmetric positive definite system by Cholesky's method.
function solveDense(matrix, right) {
  const n = right.length, lower = matrix.map(row => Float64Array.from(row)), x = Float64Array.from(right);
  for (let i = 0; i < n; i++) {
    for (let j = 0; j <= i; j++) {
      let sum = lower[i][j];
      for (let k = 0; k < j; k++) sum -= lower[i][k] * lower[j][k];
      if (i === j && !(sum > 0)) throw new Error(CONTRADICTION);
      lower[i][j] = i === j ? Math.sqrt(sum) : sum / lower[j][j];
    }
    for (let k = 0; k < i; k++) x[i] -= lower[i][k] * x[k];
    x[i] /= lower[i][i];
  }
  for (let i = n - 1; i >= 0; i--) {
    for (let k = i + 1; k < n; k++) x[i] -= lower[k][i] * x[k];
    x[i] /= lower[i][i];
  }
  return x;
}

// The pressures p >= 0 with W p - b >= 0 and p (W p - b) = 0: block principal pivoting. All that have the wrong sign change
// sides at once; when that has not helped a few times, only the last of them does, which is known to end for such matrices.
function pressures(W, b) {
  const m = b.length, pressing = new Array(m).fill(true);
  let fewest = Infinity, patience = 5, p = new Float64Array(m);
  for (let round = 0; round < 50 + 20 * m; round++) {
    const inside = pressing.flatMap((is, i) => is ? [i] : []);
    p = new Float64Array(m);
    solveDense(inside.map(i => inside.map(j => W[i][j])), inside.map(i => b[i])).forEach((x, k) => { p[inside[k]] = x; });
    const tiny = 1e-12 * Math.max(...p.map(Math.abs), 1e-30);
    const wrong = [];
    for (let i = 0; i < m; i++) {
      const gap = () => W[i].reduce((sum, w, j) => sum + w * p[j], -b[i]);
      if (pressing[i] ? p[i] < -tiny : gap() < -1e-9) wrong.push(i);
    }
    if (!wrong.length) return p;
    if (wrong.length < fewest) { fewest = wrong.length; patience = 5; } else patience--;
    for (const i of patience > 0 ? wrong : wrong.slice(-1)) pressing[i] = !pressing[i];
  }
  throw new Error(CONTRADICTION);
}

// Heights of the vertices of all yarns. `yarns` holds the lengths of the edges of each; a crossing is
// { over: [yarn, edge, part], under: [yarn, edge, part] }, the part from 0 to 1 along the edge.
function solveDepths(yarns, crossings) {
  const factors = yarns.map(factorYarn);
  const row = ({ over, under }) => {
    const entries = [];
    for (const [[yarn, edge, part], sign] of [[over, 1], [under, -1]]) {
      entries.push([yarn, edge, sign * (1 - part)], [yarn, (edge + 1) % yarns[yarn].length, sign * part]);
    }
    return entries;
  };
  const rows = crossings.map(row);
  // Heights that one unit of pressure at each crossing makes, on the one or two yarns it touches.
  const answers = rows.map(entries => {
    const right = new Map();
    for (const [yarn, vertex, value] of entries) {
      if (!right.has(yarn)) right.set(yarn, new Float64Array(yarns[yarn].length));
      right.get(yarn)[vertex] += value;
    }
    return new Map([...right].map(([yarn, values]) => [yarn, solveYarn(factors[yarn], values)]));
  });
  const along = (entries, heights) => entries.reduce((sum, [yarn, vertex, value]) => {
    const of = heights.get(yarn);
    return of ? sum + value * of[vertex] : sum;
  }, 0);
  const W = rows.map(entries => Float64Array.from(answers, heights => along(entries, heights)));
  // Two crossings on one place say the same: a little softness keeps the matrix regular.
  W.forEach((line, i) => { line[i] *= 1 + 1e-12; });
  const p = pressures(W, crossings.map(() => 2));
  const heights = yarns.map(steps => new Float64Array(steps.length));
  answers.forEach((answer, c) => {
    for (const [yarn, values] of answer) values.forEach((z, i) => { heights[yarn][i] += p[c] * z; });
  });
  const count = heights.reduce((sum, h) => sum + h.length, 0);
  const mean = heights.reduce((sum, h) => sum + h.reduce((s, z) => s + z, 0), 0) / Math.max(count, 1);
  for (const h of heights) h.forEach((z, i) => { h[i] = z - mean; });
  const gaps = rows.map(entries => along(entries, new Map(heights.map((h, yarn) => [yarn, h]))));
  if (gaps.some(gap => !(gap > 2 - 1e-3))) throw new Error(CONTRADICTION);
  return { heights, gaps, pressures: [...p] };
}
