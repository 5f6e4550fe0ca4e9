// uPlot with the styles of this page.
const drawn = new Map();
let paper = false;

// Size available to a chart; for print on A4, where the layout is still that of the screen.
const room = (place) => (paper ? 660 : Math.max(240, place.clientWidth - 16));

function axis(label, more) {
  const ticks = (_, values) => values.map((value) => (value == null ? "" : short(value).replace(/\.?0*e/, "e")));
  return { label, stroke: css("--ink"), grid: { stroke: css("--rule"), width: 1 }, ticks: { stroke: css("--rule") }, values: ticks, ...more };
}

const NOTHING = "nothing was measured here";

// why: text shown instead of the chart
function clear(id, why = "") {
  drawn.get(id)?.destroy();
  drawn.delete(id);
  const place = document.getElementById(id);
  place.textContent = why;
  place.setAttribute("aria-label", why);
}

// tables: each [x, y, …]; series: one entry per column of y, in order.
function chart(id, tables, series, { x, y, height = 330, legend = true, scales = {}, bands = [], hooks = {}, sync = null, whole = false }) {
  clear(id, tables.length ? "" : NOTHING);
  if (!tables.length) return;
  const place = document.getElementById(id);
  const plain = { value: (_, value) => short(value), points: { show: false } };
  const options = {
    width: room(place),
    height,
    scales: { ...scales, x: { time: false, ...scales.x } },
    legend: { show: legend },
    cursor: { drag: { x: true, y: false }, ...(sync && { sync: { key: sync, scales: ["x", null] } }) },
    series: [{ label: x, value: plain.value }, ...series.map((s) => ({ ...plain, ...s }))],
    axes: [axis(x, { ...(legend ? {} : { label: null, size: 30 }), ...(whole && { incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500] }) }), axis(y, { size: 72 })],
    bands,
    hooks,
  };
  drawn.set(id, new uPlot(options, uPlot.join(tables), place));
  place.setAttribute("aria-label", `${y} over ${x}: ${series.filter((s) => s.class !== "quiet").map((s) => s.label).join(", ")}`);
}

// ← → move the cursor, + and − zoom around it, 0 shows everything.
function chartKey(event) {
  const chart = drawn.get(event.currentTarget.id);
  if (!chart) return;
  const xs = chart.data[0], { min, max } = chart.scales.x;
  const from = xs.findIndex((x) => x >= min), to = xs.findLastIndex((x) => x <= max);
  const at = chart.cursor.idx ?? Math.round((from + to) / 2);
  const move = (index) => chart.setCursor({ left: chart.valToPos(xs[index], "x"), top: chart.over.clientHeight / 2 });
  const zoom = (factor) => {
    const half = ((max - min) * factor) / 2, middle = xs[at];
    const low = Math.max(middle - half, xs[0]), high = Math.min(middle + half, xs[xs.length - 1]);
    chart.setScale("x", { min: low, max: high });
  };
  const keys = {
    ArrowLeft: () => move(Math.max(at - 1, from)), ArrowRight: () => move(Math.min(at + 1, to)),
    "+": () => zoom(0.7), "-": () => zoom(1.4), 0: () => chart.setScale("x", { min: xs[0], max: xs[xs.length - 1] }),
  };
  if (!keys[event.key]) return;
  event.preventDefault();
  keys[event.key]();
}

for (const id of ["curve", "answer", "convergence"]) document.getElementById(id).addEventListener("keydown", chartKey);

new ResizeObserver(() => {
  for (const [id, chart] of drawn) {
    const width = room(document.getElementById(id));
    if (Math.abs(width - chart.width) > 1) chart.setSize({ width, height: chart.height });
  }
}).observe(document.getElementById("page"));
