// Matrices (by columns, as WebGL wants them), rotations, and the meshes of obstacles.

const Matrix = {
  multiply(a, b) {
    const m = new Float32Array(16);
    for (let c = 0; c < 4; ++c) for (let r = 0; r < 4; ++r) {
      let sum = 0;
      for (let k = 0; k < 4; ++k) sum += a[4 * k + r] * b[4 * c + k];
      m[4 * c + r] = sum;
    }
    return m;
  },
  perspective(slope, aspect, near, far) {
    const d = near - far;
    return new Float32Array([1 / (slope * aspect), 0, 0, 0, 0, 1 / slope, 0, 0, 0, 0, (far + near) / d, -1, 0, 0, 2 * far * near / d, 0]);
  },
  parallel(half, near, far) {
    const d = far - near;
    return new Float32Array([1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -2 / d, 0, 0, 0, -(far + near) / d, 1]);
  },
  // Rows are the new axes; the origin goes to minus `origin` in them.
  frame(x, y, z, origin) {
    const d = a => -(a[0] * origin[0] + a[1] * origin[1] + a[2] * origin[2]);
    return new Float32Array([x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, d(x), d(y), d(z), 1]);
  },
  place(rotation, position, size) {
    const m = new Float32Array(16);
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, c) => {
      const v = rotate(rotation, axis);
      for (let r = 0; r < 3; ++r) m[4 * c + r] = v[r] * size[c];
    });
    m[12] = position[0]; m[13] = position[1]; m[14] = position[2]; m[15] = 1;
    return m;
  },
};

function rotate([x, y, z, w], v) {
  const t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
  return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]];
}

function turnAbout(v, axis, angle) {
  const s = Math.sin(angle / 2);
  return rotate([axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)], v);
}

// Triangles of a solid in its own axes: places and normals in turn.
function solidMesh(solid, reach) {
  const out = [];
  const quad = (a, b, c, d) => { for (const v of [a, b, c, a, c, d]) out.push(...v); };
  if (solid.shape === "plane") {
    const at = (x, y) => [x * reach, y * reach, 0, 0, 0, 1];
    const n = 24;
    for (let i = 0; i < n; ++i) for (let j = 0; j < n; ++j) {
      const [x0, x1, y0, y1] = [i, i + 1, j, j + 1].map(k => 2 * k / n - 1);
      quad(at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1));
    }
  } else if (solid.shape === "box") {
    const h = solid.half_extents;
    for (let axis = 0; axis < 3; ++axis) for (const sign of [-1, 1]) {
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      const at = (a, b) => {
        const p = [0, 0, 0, 0, 0, 0];
        p[axis] = sign * h[axis]; p[u] = a * h[u]; p[v] = b * h[v]; p[3 + axis] = sign;
        return p;
      };
      quad(at(-1, -1), at(1, -1), at(1, 1), at(-1, 1));
    }
  } else {
    // A sphere is a capsule without a straight piece.
    const r = solid.radius, h = solid.half_length || 0, around = 64, rings = 32;
    const at = (i, j) => {
      const a = 2 * Math.PI * i / around, b = Math.PI * (j / rings - 0.5);
      const n = [Math.cos(a) * Math.cos(b), Math.sin(a) * Math.cos(b), Math.sin(b)];
      return [r * n[0], r * n[1], r * n[2] + (j > rings / 2 ? h : -h), ...n];
    };
    for (let i = 0; i < around; ++i) {
      for (let j = 0; j < rings; ++j) quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return new Float32Array(out);
}
