// Smooth curves through control points, and their even sampling. No page, no state: numbers in, numbers out.

// The second derivatives of a cubic spline at its knots, by Gauss-Seidel sweeps: each halves the error at least, because a
// knot's own weight is twice that of its neighbours together. `closed` tells whether the last piece leads back to the first.
function splineBends(values, steps, jump, closed) {
  const n = values.length, bends = new Array(n).fill(0);
  const slope = i => ((i + 1 < n ? values[i + 1] : values[0] + jump) - values[i]) / steps[i];
  const first = closed ? 0 : 1, end = closed ? n : n - 1;
  for (let sweep = 0; sweep < 60; sweep++) {
    for (let i = first; i < end; i++) {
      const before = (i + n - 1) % n, after = (i + 1) % n;
      const beside = steps[before] * bends[before] + steps[i] * bends[after];
      bends[i] = (6 * (slope(i) - slope(before)) - beside) / (2 * (steps[before] + steps[i]));
    }
  }
  return bends;
}

// A spline through points [x, y]: cubic, twice continuously differentiable, its knots spaced as the square roots of the
// chords (centripetal), so that close points make no loops. With `jump` the curve goes on from the last point to the first
// one moved by `jump`, as smoothly as elsewhere; without it ends are straight.
function splineThrough(points, jump) {
  const n = points.length, closed = !!jump, pieces = closed ? n : n - 1;
  const end = i => i < n ? points[i] : [points[0][0] + jump[0], points[0][1] + jump[1]];
  const chords = [];
  for (let i = 0; i < pieces; i++) chords.push(Math.hypot(end(i + 1)[0] - points[i][0], end(i + 1)[1] - points[i][1]));
  // Points on one place still need a step; a thousandth of the mean chord moves nothing that is seen.
  const mean = chords.reduce((sum, c) => sum + c, 0) / Math.max(pieces, 1);
  const steps = chords.map(c => Math.sqrt(Math.max(c, 1e-3 * mean, 1e-12)));
  const bends = [0, 1].map(axis => splineBends(points.map(p => p[axis]), steps, closed ? jump[axis] : 0, closed));
  return { points, steps, bends, pieces, jump: jump || null, end };
}

// The place on piece `i` at the part `t` from 0 to 1 of it.
function splineAt(spline, i, t) {
  const h = spline.steps[i], s = 1 - t, after = (i + 1) % spline.points.length, to = spline.end(i + 1);
  return [0, 1].map(axis => {
    const bends = spline.bends[axis];
    const bow = (s * s * s - s) * bends[i] + (t * t * t - t) * bends[after];
    return s * spline.points[i][axis] + t * to[axis] + h * h / 6 * bow;
  });
}

// A fine polyline of the spline: places, the piece and part of each, and the length from the beginning to each. A closed
// curve ends with the image of its first place.
function splinePolyline(spline, each = 24) {
  const line = { places: [], pieces: [], lengths: [0] };
  for (let i = 0; i < spline.pieces; i++) {
    for (let k = 0; k < each; k++) {
      line.places.push(splineAt(spline, i, k / each));
      line.pieces.push(i + k / each);
    }
  }
  if (spline.pieces > 0) {
    line.places.push(splineAt(spline, spline.pieces - 1, 1));
    line.pieces.push(spline.pieces);
  } else if (spline.points.length) {
    line.places.push(spline.points[0]);
    line.pieces.push(0);
  }
  for (let i = 1; i < line.places.length; i++) {
    const [a, b] = [line.places[i - 1], line.places[i]];
    line.lengths.push(line.lengths[i - 1] + Math.hypot(b[0] - a[0], b[1] - a[1]));
  }
  return line;
}

// The places of a polyline at rising lengths along it, each with its piece (a number such as 2.4: four tenths of piece 2).
function placesAt(line, lengths) {
  const found = [];
  let i = 1;
  for (const length of lengths) {
    while (i < line.lengths.length - 1 && line.lengths[i] < length) i++;
    const span = line.lengths[i] - line.lengths[i - 1];
    const t = span > 0 ? Math.min(Math.max((length - line.lengths[i - 1]) / span, 0), 1) : 0;
    const mix = (a, b) => a + t * (b - a);
    const [a, b] = [line.places[i - 1], line.places[i]];
    found.push({ at: [mix(a[0], b[0]), mix(a[1], b[1])], piece: mix(line.pieces[i - 1], line.pieces[i]), length });
  }
  return found;
}

// The place of a polyline next to a point: its distance, piece and place.
function nearestOnLine(line, point) {
  let best = { distance: Infinity, piece: 0, at: point };
  for (let i = 1; i < line.places.length; i++) {
    const [a, b] = [line.places[i - 1], line.places[i]];
    const d = [b[0] - a[0], b[1] - a[1]], e = [point[0] - a[0], point[1] - a[1]];
    const square = d[0] * d[0] + d[1] * d[1];
    const t = square > 0 ? Math.min(Math.max((d[0] * e[0] + d[1] * e[1]) / square, 0), 1) : 0;
    const at = [a[0] + t * d[0], a[1] + t * d[1]];
    const distance = Math.hypot(point[0] - at[0], point[1] - at[1]);
    if (distance < best.distance) best = { distance, at, piece: line.pieces[i - 1] + t * (line.pieces[i] - line.pieces[i - 1]) };
  }
  return best;
}
