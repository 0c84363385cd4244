// The work: the tile on the photograph and the yarns laid over it, as plain data that is saved as JSON. Places of control
// points are parts of the two periods, so that they say the same on the photograph (pixels) and in the fabric (metres).

const LAYERS = ["front", "back", "hidden"];
const COLORS = ["#e0402f", "#2f7de0", "#2fae54", "#d99a1c", "#9a4fd0", "#12a8a8", "#d0478f", "#7a7f1f"];
const MOST_YARNS = 64, MOST_POINTS = 2000, MOST_TILES = 8;

// A work to begin with: the tile in the middle of the front photograph, in the given scale [m/px] or over half of it.
function newWork({ periods, radius, scale, size }) {
  const fit = 0.5 * Math.min(size[0] / periods[0], size[1] / periods[1]);
  const perMetre = scale ? 1 / scale : fit;
  const [w, h] = periods.map(p => p * perMetre);
  return {
    format: "wale-register", version: 1, periods_m: periods.slice(), radius_m: radius, spacing_radii: 1,
    tile: { origin_px: [(size[0] - w) / 2, (size[1] + h) / 2], along_px: [w, 0], across_px: [0, -h] },
    back: { mirrored: true, shift_px: [0, 0], turn_rad: 0, scale: 1 },
    yarns: [], orders: [],
  };
}

// Of a part of the tile the pixel on the front photograph, and back.
function toPixel({ tile }, [a, b]) {
  return [0, 1].map(k => tile.origin_px[k] + a * tile.along_px[k] + b * tile.across_px[k]);
}

function fromPixel({ tile }, pixel) {
  const [u, v] = [tile.along_px, tile.across_px], d = [0, 1].map(k => pixel[k] - tile.origin_px[k]);
  const area = u[0] * v[1] - u[1] * v[0];
  return [(d[0] * v[1] - d[1] * v[0]) / area, (u[0] * d[1] - u[1] * d[0]) / area];
}

// Metres a pixel along both periods, as the tile lies on the photograph.
function scalesOf(work) {
  return [work.periods_m[0] / Math.hypot(...work.tile.along_px), work.periods_m[1] / Math.hypot(...work.tile.across_px)];
}

// Puts the tile elsewhere; control points stay on the photograph, or move along with it.
function placeTile(work, tile, pointsStay) {
  const pixels = work.yarns.map(yarn => yarn.points.map(point => toPixel(work, point.at)));
  const orders = work.orders.map(order => toPixel(work, order.at.map((x, k) => x / work.periods_m[k])));
  work.tile = tile;
  if (!pointsStay) return;
  work.yarns.forEach((yarn, y) => yarn.points.forEach((point, p) => { point.at = fromPixel(work, pixels[y][p]); }));
  work.orders.forEach((order, o) => { order.at = fromPixel(work, orders[o]).map((x, k) => x * work.periods_m[k]); });
}

// Other periods [m]. Control points keep their parts of the tile; decisions about crossings, which are in metres, follow.
function setPeriodsOf(work, periods) {
  for (const order of work.orders) order.at = order.at.map((x, k) => x / work.periods_m[k] * periods[k]);
  work.periods_m = periods.slice();
}

// In which tile the image of the first point lies that a yarn most likely goes on to: the nearest to where its last piece
// points, one period or a few away but not the first point itself.
function likelyClosing(work, yarn) {
  const points = yarn.points.map(point => point.at.map((x, k) => x * work.periods_m[k]));
  const first = points[0], last = points[points.length - 1], before = points[points.length - 2] || last;
  let best = { distance: Infinity, closes: [1, 0] };
  for (let i = -2; i <= 2; i++) {
    for (let j = -2; j <= 2; j++) {
      if (!i && !j) continue;
      const image = [first[0] + i * work.periods_m[0], first[1] + j * work.periods_m[1]];
      // Half a step ahead: an image behind the pen is less likely than one before it.
      const pen = last.map((x, k) => x + 0.5 * (x - before[k]));
      const distance = Math.hypot(image[0] - pen[0], image[1] - pen[1]);
      if (distance < best.distance - 1e-12) best = { distance, closes: [i, j] };
    }
  }
  return best.closes;
}

// Takes a yarn out, and the decisions about its crossings.
function removeYarn(work, index) {
  work.yarns.splice(index, 1);
  work.orders = work.orders.filter(order => order.over !== index && order.under !== index);
  for (const order of work.orders) for (const key of ["over", "under"]) if (order[key] > index) order[key]--;
}

// Saved work as text, and back. Whatever the text holds, the answer is a whole work or an error that says what is wrong.
function writeWork(work) {
  return JSON.stringify(work, null, 1);
}

function readWork(text) {
  let found;
  try { found = JSON.parse(text); } catch (error) { throw new Error("This is no saved work: " + error.message); }
  const refuse = (what, why) => { throw new Error(`The saved work cannot be read: ${what} ${why}.`); };
  const isNumber = x => typeof x === "number" && Number.isFinite(x) && Math.abs(x) < 1e9;
  const number = (x, what) => isNumber(x) ? x : refuse(what, "is not a number");
  const positive = (x, what) => isNumber(x) && x > 0 ? x : refuse(what, "is not a positive number");
  const pair = (x, what, one = number) => Array.isArray(x) && x.length === 2 ? x.map(v => one(v, what)) : refuse(what, "is not two numbers");
  const list = (x, most, what) => Array.isArray(x) && x.length <= most ? x : refuse(what, `is not a list of at most ${most}`);
  const whole = (x, least, end, what) => Number.isInteger(x) && x >= least && x < end ? x : refuse(what, "is out of range");
  if (!found || typeof found !== "object" || found.format !== "wale-register") refuse("the file", "does not say that its format is wale-register");
  if (found.version !== 1) refuse("its version", "is not 1, the one that this page knows");
  const tile = {};
  for (const key of ["origin_px", "along_px", "across_px"]) tile[key] = pair(found.tile && found.tile[key], `tile.${key}`);
  if (Math.abs(tile.along_px[0] * tile.across_px[1] - tile.along_px[1] * tile.across_px[0]) < 1e-6) refuse("tile", "has no area");
  const back = found.back || {};
  const yarns = list(found.yarns, MOST_YARNS, "yarns").map((yarn, y) => ({
    name: String(yarn && yarn.name || `yarn ${y + 1}`).slice(0, 60),
    color: /^#[0-9a-f]{6}$/i.test(yarn && yarn.color) ? yarn.color : COLORS[y % COLORS.length],
    closes: yarn && yarn.closes ? pair(yarn.closes, `yarns[${y}].closes`, (x, what) => whole(x, -MOST_TILES, MOST_TILES + 1, what)) : null,
    points: list(yarn && yarn.points, MOST_POINTS, `yarns[${y}].points`).map((point, p) => ({
      at: pair(point && point.at, `yarns[${y}].points[${p}].at`),
      layer: LAYERS.includes(point.layer) ? point.layer : refuse(`yarns[${y}].points[${p}].layer`, `is none of ${LAYERS.join(", ")}`),
    })),
  }));
  const yarn = (x, what) => whole(x, 0, yarns.length, what);
  return {
    format: "wale-register", version: 1,
    periods_m: pair(found.periods_m, "periods_m", positive), radius_m: positive(found.radius_m, "radius_m"),
    spacing_radii: Math.min(Math.max(positive(found.spacing_radii, "spacing_radii"), 0.25), 4), tile,
    back: {
      mirrored: back.mirrored !== false, shift_px: pair(back.shift_px || [0, 0], "back.shift_px"),
      turn_rad: number(back.turn_rad || 0, "back.turn_rad"), scale: positive(back.scale || 1, "back.scale"),
    },
    yarns,
    orders: list(found.orders || [], 10000, "orders").map((order, o) => ({
      over: yarn(order && order.over, `orders[${o}].over`), under: yarn(order.under, `orders[${o}].under`),
      end: whole(order.end, 0, 2, `orders[${o}].end`), at: pair(order.at, `orders[${o}].at`),
    })),
  };
}
