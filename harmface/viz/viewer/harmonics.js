// Rotations as rows of three rows, and what light becomes under them.

const IDENTITY = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/** Return the product of two matrices. */
function product(a, b) {
  return a.map((row) => b[0].map((_, j) => row.reduce((sum, value, k) => sum + value * b[k][j], 0)));
}

function transposed(matrix) {
  return matrix[0].map((_, j) => matrix.map((row) => row[j]));
}

/** Return the rotation by an angle in radians about axis 0 (x), 1 (y) or 2 (z). */
function rotationAbout(axis, angle) {
  const [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
  const rotation = IDENTITY.map((row) => [...row]);
  rotation[a][a] = rotation[b][b] = Math.cos(angle);
  rotation[b][a] = Math.sin(angle);
  rotation[a][b] = -rotation[b][a];
  return rotation;
}

/** Return the nearest rotation's approximation: rows made unit and at right angles again. */
function orthonormal([x, y]) {
  const unit = (v) => v.map((value) => value / Math.hypot(...v));
  const first = unit(x);
  const along = first.reduce((sum, value, i) => sum + value * y[i], 0);
  const second = unit(y.map((value, i) => value - along * first[i]));
  const third = [0, 1, 2].map(
    (i) => first[(i + 1) % 3] * second[(i + 2) % 3] - first[(i + 2) % 3] * second[(i + 1) % 3],
  );
  return [first, second, third];
}

/** Return the real harmonics of a direction, in the order l (l + 1) + m, signs as RH01 eq. 3. */
function harmonics([x, y, z], maxDegree) {
  const values = new Array((maxDegree + 1) ** 2);
  let [cosine, sine, diagonal, factorials] = [1, 0, 1, 1];
  for (let m = 0; m <= maxDegree; m += 1) {
    // Legendre functions P_l^m over sin^m, whose sin^m stands in (x + i y)^m; `factorials` is
    // (l + m)! / (l - m)!.
    let [before, legendre, ratio] = [0, diagonal, factorials];
    for (let l = m; l <= maxDegree; l += 1) {
      const factor = Math.sqrt(((2 * l + 1) / (4 * Math.PI) / ratio) * (m ? 2 : 1));
      values[l * (l + 1) + m] = factor * legendre * cosine;
      if (m) values[l * (l + 1) - m] = factor * legendre * sine;
      const next = ((2 * l + 1) * z * legendre - (l + m) * before) / (l + 1 - m);
      [before, legendre] = [legendre, next];
      ratio *= (l + 1 + m) / (l + 1 - m);
    }
    [cosine, sine] = [cosine * x - sine * y, cosine * y + sine * x];
    diagonal *= 2 * m + 1;
    factorials *= (2 * m + 1) * (2 * m + 2);
  }
  return values;
}

/**
 * Return coefficients (channels x K) of light turned by a rotation: w -> f(R^-1 w).
 *
 * They are integrals of the turned light times each harmonic, by a quadrature that is exact.
 */
function rotated(coefficients, rotation, { directions, weights }) {
  const count = coefficients[0].length;
  const maxDegree = Math.sqrt(count) - 1;
  const inverse = transposed(rotation);
  const turned = coefficients.map(() => new Array(count).fill(0));
  directions.forEach((direction, i) => {
    const there = harmonics(direction, maxDegree);
    const before = inverse.map((row) => row.reduce((sum, value, k) => sum + value * direction[k], 0));
    const basis = harmonics(before, maxDegree);
    coefficients.forEach((own, channel) => {
      const radiance = own.reduce((sum, value, k) => sum + value * basis[k], 0);
      there.forEach((value, k) => {
        turned[channel][k] += weights[i] * radiance * value;
      });
    });
  });
  return turned;
}

/** Return M of RH01 eq. 12 for one channel, 16 numbers; `each` is M of every coefficient alone. */
function irradianceMatrix(coefficients, each) {
  const total = new Array(16).fill(0);
  each.forEach((matrix, k) => matrix.forEach((value, i) => { total[i] += coefficients[k] * value; }));
  return total;
}

/** Return E(n) = (n, 1)^T M (n, 1), RH01 eq. 11; M is symmetric. */
function irradiance(m, [x, y, z]) {
  return x * (m[0] * x + 2 * (m[1] * y + m[2] * z + m[3]))
    + y * (m[5] * y + 2 * (m[6] * z + m[7]))
    + z * (m[10] * z + 2 * m[11]) + m[15];
}
