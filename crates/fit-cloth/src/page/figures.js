// Content of each chart.

// A component's curve in several fits, with bands and control points, and the first fit's histogram below.
function drawCurve(component, fits) {
  const tables = [], series = [], bands = [];
  const curves = fits.map((fit) => [fit, fit.curves.find((c) => c.component === component)]).filter(([, curve]) => curve.observed);
  // The first fit is drawn last, on top of the others.
  for (const [fit, curve] of [...curves].reverse()) {
    const stroke = colourOf(fit), column = (i) => curve.samples.map((sample) => sample[i] ?? null);
    const banded = curve.samples.some((sample) => sample.length === 4);
    tables.push([column(0), column(1), ...(banded ? [column(2), column(3)] : [])]);
    const sides = (u, at, index) => (banded && at != null ? ` (${short(u.data[index + 1]?.[at])} … ${short(u.data[index + 2]?.[at])})` : "");
    series.push({ label: labelOf(fit), stroke, width: 2.5, dash: dashOf(fit), value: (u, v, index, at) => short(v) + sides(u, at, index) });
    if (banded) {
      series.push(...["low", "high"].map((label) => ({ label, class: "quiet", stroke, width: 0.5 })));
      bands.push({ series: [series.length, series.length - 1], fill: stroke + "30" });
    }
    tables.push([curve.points.map((p) => p.strain), curve.points.map((p) => p.stress)]);
    series.push({ label: "control points", class: "quiet", stroke, paths: () => null, points: { show: true, size: 9, fill: stroke } });
  }
  const own = fits[0].curves.find((c) => c.component === component);
  document.getElementById("histogram").hidden = !own.observed;
  if (!curves.length) { clear("curve", "no curve"); clear("histogram"); return; }
  const ends = (values) => [Math.min(...values), Math.max(...values)];
  const points = curves.flatMap(([, curve]) => curve.points), samples = curves.flatMap(([, curve]) => curve.samples);
  const [left, right] = ends([0, ...points.map((p) => p.strain), ...samples.map((sample) => sample[0])]);
  // A band much wider than the curve is high is cut off, so that it does not flatten the curve.
  const [bottom, top] = ends([0, ...points.map((p) => p.stress), ...samples.map((sample) => sample[1])]);
  const [below, above] = ends([bottom, top, ...samples.flatMap((sample) => sample.slice(2))]);
  const height = top - bottom || 1;
  const extent = [Math.max(below, bottom - height) - 0.04 * height * (below < 0), Math.min(above, top + height) + 0.04 * height];
  const across = (_, low, high) => (low == null || low === high ? [left, right] : [low, high]);
  const upwards = (_, low, high) => (low == null ? extent : [Math.max(low, extent[0]), Math.min(high + 0.04 * (high - low), extent[1])]);
  const scales = { x: { range: across }, y: { range: upwards } };
  // Parts of the selected curve that the measurement did not visit, on either side.
  const shade = (u) => {
    if (!own.observed) return;
    const [first, last] = ends(own.points.map((p) => p.strain));
    for (const [from, to] of [[first, own.visited[0]], [own.visited[1], last]]) {
      const [x, end] = [from, to].map((at) => Math.min(Math.max(u.valToPos(at, "x", true), u.bbox.left), u.bbox.left + u.bbox.width));
      if (end <= x + 1) continue;
      u.ctx.save();
      u.ctx.fillStyle = css("--shade");
      u.ctx.fillRect(x, u.bbox.top, end - x, u.bbox.height);
      u.ctx.restore();
    }
  };
  const hooks = { drawClear: [shade] };
  // Models differ in their strain measure: on a shared axis, each curve is over its own.
  const label = (axis, shared) => (new Set(curves.map(([, curve]) => curve[axis])).size > 1 ? shared : own[axis]);
  const x = label("x_label", "strain, of each model [–]"), y = label("y_label", "stress, of each model [N/m]");
  chart("curve", tables, series, { x, y, bands, scales, hooks, sync: "curve" });
  if (!own.observed) { clear("histogram"); return; }
  const { range: [from, to], shares } = own.histogram, width = (to - from) / shares.length;
  const middles = shares.map((_, i) => from + (i + 0.5) * width);
  // Same extent as the chart above: no column at either end.
  const xs = [[left, null], ...middles.map((x, i) => [x, 100 * shares[i]]), [right, null]].filter(([x], i, all) => i === 0 || x > all[i - 1][0]);
  const bars = uPlot.paths.bars({ size: [1, 40], align: 0 });
  chart("histogram", [[xs.map(([x]) => x), xs.map(([, share]) => share)]],
    [{ label: "share", stroke: css("--measured"), fill: css("--shade"), width: 1, paths: bars }],
    { x: own.x_label, y: "sheets [%]", height: 110, legend: false, sync: "curve", hooks });
}

// Runs of successive frames with growing or shrinking force; each begins where the last one ended. A chart needs
// ascending x, so one line cannot go back and forth.
function runs(forces) {
  const found = [];
  for (const force of forces) {
    const last = found.at(-1);
    if (last?.phase === force.phase) last.rows.push(force);
    else found.push({ phase: force.phase, rows: last ? [last.rows.at(-1), force] : [force] });
  }
  for (const { rows } of found) rows.sort((a, b) => a.extension - b.extension);
  return found.map(({ phase, rows }) => ({ phase, rows: rows.filter((row, i) => i === 0 || row.extension > rows[i - 1].extension) }));
}

// Pulling force over extension, or the profiles of a sheet pushed off a table.
function drawAnswer(name, fits) {
  const found = fits.map((fit) => [fit, fit.sequences.find((s) => s.name === name)]).filter(([, sequence]) => sequence);
  const title = document.getElementById("answer-title");
  clear("answer");
  if (!found.length) return;
  const sequence = found[0][1];
  if (sequence.profiles.length) {
    title.textContent = "Profiles across the table's edge: measured thin, model thick";
    const place = document.getElementById("answer");
    const drawing = profiles(found, room(place));
    if (!drawing) { clear("answer", NOTHING); return; }
    place.append(drawing);
    place.setAttribute("aria-label", "profiles of all frames: height over the distance outward of the edge");
    return;
  }
  title.textContent = `Clip force over ${sequence.extension}: measured thin, model thick`;
  const tables = [], series = [];
  const add = (forces, key, style, name) => runs(forces).forEach(({ phase, rows }, i, all) => {
    const label = name(phase), again = all.slice(0, i).some((run) => name(run.phase) === label);
    tables.push([rows.map((f) => f.extension), rows.map((f) => f[key])]);
    series.push({ label, ...style, dash: style.dash ?? (phase === "unloading" ? [3, 3] : []), ...(again && { class: "quiet" }) });
  });
  for (const [fit, { forces }] of [...found].reverse()) {
    add(forces, "simulated", { stroke: colourOf(fit), dash: dashOf(fit), width: 3 }, () => labelOf(fit));
  }
  add(sequence.forces, "measured", { stroke: css("--ink"), width: 1, points: { show: true, size: 6 } }, (phase) => `measured, ${phase}`);
  chart("answer", tables, series, { x: sequence.extension, y: "clip force [N]" });
}

const SVG = "http://www.w3.org/2000/svg";

function shape(name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text != null) made.textContent = text;
  return made;
}

// Ticks at steps of 1, 2 or 5 × 10ⁿ between two numbers, about as many as requested.
function steps(low, high, about) {
  const rough = (high - low) / about, decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((n) => n * decade).find((s) => s >= rough);
  const marks = [];
  for (let at = Math.ceil(low / step) * step; at <= high + 1e-9 * step; at += step) marks.push(+at.toPrecision(6));
  return marks;
}

// Both axes to the same scale, in mm. Drawn as SVG: uPlot needs ascending x and cannot show a sheet that hangs straight
// down.
//
// available: width in pixels; returns nothing if no node was observed
function profiles(found, available) {
  const mm = (points) => points.filter((p) => p[0] != null).map((p) => p.map((c) => 1e3 * c));
  const lines = [...found].reverse().flatMap(([fit, sequence]) => sequence.profiles.map((p) => [mm(p.simulated), colourOf(fit), 2.6, dashOf(fit)]));
  lines.push(...found[0][1].profiles.map((p) => [mm(p.measured), css("--ink"), 1, []]));
  const all = lines.flatMap(([points]) => points);
  if (!all.length) return null;
  const bound = (i, rule) => rule(...all.map((p) => p[i]));
  const [left, right, bottom, top] = [bound(0, Math.min), bound(0, Math.max), bound(1, Math.min), bound(1, Math.max)];
  const scale = Math.min((Math.min(available, 900) - 90) / (right - left), 400 / (top - bottom || 1));
  const [width, height] = [(right - left) * scale, (top - bottom) * scale];
  const x = (v) => 70 + (v - left) * scale, y = (v) => 16 + (top - v) * scale;
  const svg = shape("svg", { viewBox: `0 0 ${width + 90} ${height + 76}`, style: `max-width: ${width + 90}px`, "font-family": "inherit" });
  for (const mark of steps(left, right, Math.max(2, Math.round(width / 80)))) {
    svg.append(shape("line", { x1: x(mark), x2: x(mark), y1: 16, y2: 16 + height, stroke: css("--rule") }));
    svg.append(shape("text", { x: x(mark), y: height + 36, "text-anchor": "middle" }, mark));
  }
  for (const mark of steps(bottom, top, Math.max(2, Math.round(height / 60)))) {
    svg.append(shape("line", { x1: 70, x2: 70 + width, y1: y(mark), y2: y(mark), stroke: css("--rule") }));
    svg.append(shape("text", { x: 62, y: y(mark) + 4, "text-anchor": "end" }, mark));
  }
  for (const [points, stroke, thick, dash] of lines) {
    const along = points.map(([a, b]) => `${x(a).toFixed(1)},${y(b).toFixed(1)}`).join(" ");
    svg.append(shape("polyline", { points: along, fill: "none", stroke, "stroke-width": thick, "stroke-dasharray": dash.join(" ") }));
  }
  svg.append(shape("text", { x: 70 + width / 2, y: height + 62, "text-anchor": "middle" }, "outward of the edge [mm]"));
  svg.append(shape("text", { transform: `translate(16 ${16 + height / 2}) rotate(-90)`, "text-anchor": "middle" }, "height [mm]"));
  return svg;
}

function drawConvergence(fit) {
  const courses = fit.courses.filter((course) => course.rms.length && course.rms.at(-1) > 0);
  const tables = courses.map(({ rms }) => [rms.map((_, step) => step + 1), rms.map((r) => r / rms.at(-1))]);
  const style = ({ name }, i) => ({ label: name, stroke: css(`--c${i % 3}`), dash: DASHES[Math.floor(i / 3) % 4], width: 2, points: { show: true, size: 4 } });
  chart("convergence", tables, courses.map(style), {
    x: "step tried", y: "rms residual over its last", scales: { y: { distr: 3 } }, whole: true,
  });
}

// Cells from blue (−1) over paper (0) to vermillion (+1).
function correlationCell(cell, value) {
  if (value == null) return;
  const hue = value < 0 ? "--c0" : "--c1";
  cell.style.background = `color-mix(in srgb, var(${hue}) ${Math.round(70 * Math.abs(value))}%, var(--paper))`;
}
