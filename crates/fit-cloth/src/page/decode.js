// Decodes the page's data. Numbers are those of material.json, residuals.csv and forces.csv.
const page = JSON.parse(document.getElementById("data").textContent);

// Coordinates are 16-bit integers, ±32767 for the sequence's reach around its middle; the minimum means "not observed".
const NOT_SEEN = -32768;

function bytes(text) {
  const raw = atob(text);
  const array = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) array[i] = raw.charCodeAt(i);
  return array.buffer;
}

function places(text, { middle, reach }) {
  if (!text) return null;
  const packed = new Int16Array(bytes(text));
  return Float32Array.from(packed, (value, i) => (value === NOT_SEEN ? NaN : middle[i % 3] + (reach * value) / 32767));
}

// The sequence with its mesh and frames as arrays, decoded on first use.
function unpacked(sequence) {
  if (!sequence.mesh) {
    const triangles = new Uint32Array(bytes(sequence.triangles));
    sequence.mesh = { triangles, lines: edges(triangles), material: new Float32Array(bytes(sequence.material)) };
    for (const frame of sequence.frames) {
      frame.simulated = places(frame.simulated, sequence);
      frame.measured = places(frame.measured, sequence);
    }
  }
  return sequence;
}

// Edges as pairs of nodes, each once.
function edges(triangles) {
  const seen = new Set(), pairs = [];
  for (let t = 0; t < triangles.length; t++) {
    const a = triangles[t], b = triangles[t % 3 === 2 ? t - 2 : t + 1];
    const name = Math.min(a, b) + "/" + Math.max(a, b);
    if (!seen.has(name)) { seen.add(name); pairs.push(a, b); }
  }
  return pairs;
}

// Larger eigenvalue of E = (FᵀF − I)/2 in each triangle, averaged over the triangles at each node.
function strains({ triangles, material }, x) {
  const sums = new Float32Array(x.length / 3), counts = new Float32Array(x.length / 3);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = triangles.subarray(t, t + 3);
    const rest = (n, i) => material[2 * n + i] - material[2 * a + i];
    const [du1, dv1, du2, dv2] = [rest(b, 0), rest(b, 1), rest(c, 0), rest(c, 1)];
    const det = du1 * dv2 - du2 * dv1;
    let uu = 0, uv = 0, vv = 0;
    for (let i = 0; i < 3; i++) {
      const p = x[3 * b + i] - x[3 * a + i], q = x[3 * c + i] - x[3 * a + i];
      const wu = (p * dv2 - q * dv1) / det, wv = (q * du1 - p * du2) / det;
      uu += wu * wu; uv += wu * wv; vv += wv * wv;
    }
    const strain = ((uu + vv) / 2 + Math.hypot((uu - vv) / 2, uv) - 1) / 2;
    if (Number.isNaN(strain)) continue;
    for (const n of [a, b, c]) { sums[n] += strain; counts[n] += 1; }
  }
  return sums.map((sum, n) => sum / counts[n]);
}

function distances(x, y) {
  return Float32Array.from({ length: x.length / 3 }, (_, n) =>
    Math.hypot(x[3 * n] - y[3 * n], x[3 * n + 1] - y[3 * n + 1], x[3 * n + 2] - y[3 * n + 2]));
}
