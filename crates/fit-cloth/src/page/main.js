const byId = (id) => document.getElementById(id);
const viewer = new Viewer(byId("view"));
const best = page.ranking?.rows.map(([model, variant]) => page.fits.find((each) => each.model === model && each.variant === variant)).find(Boolean);
let fit = best ?? page.fits[0], component = null, sequence = null, frame = 0, timer = null;
// With many fits, those of one variant are compared.
const beside = new Set(page.fits.filter((other) => other.variant === fit.variant));

function element(name, text, attributes = {}) {
  const made = document.createElement(name);
  if (text != null) made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

// Buttons to choose one or several names; hidden if there is no choice.
function choice(id, names, pressed, choose, dress = () => ({})) {
  const place = byId(id), focus = [...place.querySelectorAll("button")].indexOf(document.activeElement);
  place.hidden = names.length < 2;
  place.replaceChildren(place.querySelector("legend"), ...names.map((name) => {
    const button = element("button", name, { type: "button", "aria-pressed": String(pressed(name)), ...dress(name) });
    button.addEventListener("click", () => choose(name));
    return button;
  }));
  // Keep the focus after a choice by keyboard.
  place.querySelectorAll("button")[focus]?.focus();
}

// texts: columns that hold text; each: callback for a cell.
function table(id, header, rows, texts = [0], each = () => {}) {
  const made = (cells, kind, row) => {
    const line = element("tr");
    line.append(...cells.map((text, column) => {
      const cell = element(kind, text ?? "–", texts.includes(column) ? { class: "text" } : {});
      if (kind === "td") each(cell, row, column, line);
      return cell;
    }));
    return line;
  };
  byId(id).replaceChildren(made(header, "th"), ...rows.map((cells, row) => made(cells, "td", row)));
}

const list = (id, lines) => byId(id).replaceChildren(...lines.map((line) => element("li", line)));

// The selected fit, then those compared with it.
const shown = () => [fit, ...page.fits.filter((other) => other !== fit && beside.has(other))];

function showFit(chosen) {
  fit = chosen;
  const others = { model: "variant", variant: "model" };
  const nearest = (key, name) => page.fits.find((each) => each[key] === name && each[others[key]] === fit[others[key]]) ?? page.fits.find((each) => each[key] === name);
  choice("models", MODELS, (name) => name === fit.model, (name) => showFit(nearest("model", name)));
  choice("variants", VARIANTS, (name) => name === fit.variant, (name) => showFit(nearest("variant", name)));
  const labelled = (label) => page.fits.find((each) => labelOf(each) === label);
  const toggle = (label) => {
    if (!beside.delete(labelled(label))) beside.add(labelled(label));
    showFit(fit);
  };
  const line = (label) => ({ ...(labelled(label) === fit && { disabled: "" }), style: `--colour: ${colourOf(labelled(label))}; --line: ${LINES[VARIANTS.indexOf(labelled(label).variant) % 4]}` });
  choice("beside", page.fits.map(labelOf), (label) => shown().includes(labelled(label)), toggle, line);
  byId("trust").className = fit.sound ? "good" : "bad";
  for (const words of ["trust", "state", "good", "sure", "next", "about"]) byId(words).textContent = fit[words];
  list("failures", fit.failures);
  list("notices", fit.notices);
  table("summary", ["curve", "points", "at the end of the range", "± 95 %", "range seen", "observed by"], fit.summary, [0, 5]);
  showRanking();
  table("residuals",
    ["test", "frames", "left out", "several equilibria", "rms force [N]", "of largest", "rms position [mm]", "loading : curve", "unloading : curve"],
    fit.residuals.map((r) => [r.predicted ? `${r.sequence} (predicted)` : r.sequence, r.frames, r.frames_left_out, r.multi_stable_frames,
      short(r.rms_force_n), r.largest_force_n ? ((100 * r.rms_force_n) / r.largest_force_n).toFixed(2) + " %" : null,
      r.rms_position_m == null ? null : short(1e3 * r.rms_position_m), short(r.loading_stiffness), short(r.unloading_stiffness)]));
  const components = fit.curves.map((curve) => curve.component);
  component ??= fit.curves.find((curve) => curve.observed)?.component ?? components[0];
  const names = fit.sequences.map((each) => each.name);
  byId("sequence").replaceChildren(...names.map((name) => element("option", name)));
  showCurve();
  showSequence(names.includes(sequence?.name) ? sequence.name : names[0]);
  drawConvergence(fit);
}

function showRanking() {
  byId("ranking-section").hidden = !page.ranking;
  if (!page.ranking) return;
  const { by, notes, columns, rows } = page.ranking;
  const chosen = rows.findIndex(([model, variant]) => model === fit.model && variant === fit.variant);
  table("ranking", columns, rows, [0, 1], (cell, row, column, line) => { if (row === chosen) line.className = "chosen"; });
  byId("ranked-by").textContent = [by, ...notes].join(" ");
}

function showCurve() {
  const curve = fit.curves.find((each) => each.component === component);
  choice("components", fit.curves.map((each) => each.component), (name) => name === component, (name) => { component = name; showCurve(); });
  drawCurve(component, shown());
  byId("curves-title").textContent = `Curves: ${component}`;
  byId("verdict").textContent = curve.verdict;
  const per = (share) => (share == null ? null : `± ${(100 * share).toFixed(1)} %`);
  table("points", [curve.x_label, curve.stiffness_label, "95 %", curve.y_label],
    curve.points.map((p) => [short(p.strain), short(p.stiffness), per(p.share), short(p.stress)]));
  const numbers = curve.correlations.map((_, i) => i + 1);
  table("correlations", ["", ...numbers], curve.correlations.map((row, i) => [i + 1, ...row.map((c) => (c == null ? null : c.toFixed(2)))]), [],
    (cell, row, column) => { if (column > 0) correlationCell(cell, curve.correlations[row][column - 1]); });
  for (const id of ["points", "correlations"]) byId(id).parentElement.hidden = !curve.observed;
  byId("correlations").closest(".columns").hidden = !curve.observed;
  list("course", curve.course);
  byId("course").parentElement.hidden = !curve.course.length;
}

function showSequence(name) {
  const next = fit.sequences.find((each) => each.name === name);
  const other = next?.name !== sequence?.name;
  sequence = next;
  byId("frames-section").hidden = !sequence?.frames.length;
  if (!sequence?.frames.length) play(false);
  if (!sequence) { clear("answer", "no test was used"); return; }
  byId("sequence").value = name;
  drawAnswer(name, shown());
  if (!sequence.frames.length) return;
  byId("frames-title").textContent = `Frames of ${name}`;
  unpacked(sequence);
  byId("frame").max = sequence.frames.length - 1;
  const seen = sequence.frames.some((each) => each.measured);
  for (const option of byId("shapes").options) option.disabled = !seen && option.value !== "simulated";
  for (const option of byId("colour").options) option.disabled = !seen && option.value === "residual";
  if (!seen) byId("shapes").value = "simulated";
  if (!seen && byId("colour").value === "residual") byId("colour").value = "strain";
  // For a newly selected test, the frame of largest extension.
  const far = (index) => Math.abs(sequence.frames[index].extension);
  const farthest = sequence.frames.reduce((best, _, index) => (far(index) > far(best) ? index : best), 0);
  showFrame(other ? farthest : Math.min(frame, sequence.frames.length - 1), other);
}

// afresh: reset the view.
function showFrame(index, afresh = false) {
  frame = index;
  byId("frame").value = index;
  const now = sequence.frames[index], which = byId("shapes").value, by = byId("colour").value;
  const [, name, unitOf] = sequence.extension.match(/^(.*) \[(.*)\]$/);
  const several = sequence.multi_stable.includes(now.frame) ? ", several equilibria" : "";
  byId("which").textContent = `frame ${now.frame}, ${name} ${short(now.extension)}${unitOf === "–" ? "" : ` ${unitOf}`}${several}`;
  const both = Boolean(now.measured);
  const values = { residual: () => both && distances(now.simulated, now.measured), strain: (x) => strains(sequence.mesh, x), plain: () => null }[by];
  const largest = by === "residual" ? sequence.largest_distance : sequence.largest_strain;
  const paint = (x, plain) => {
    const of = values(x);
    return Array.from({ length: x.length / 3 }, (_, n) => (of && !Number.isNaN(of[n]) ? viridis(of[n] / (largest || 1)) : plain));
  };
  const sheets = [];
  const model = rgb(`--c${MODELS.indexOf(fit.model) % 3}`);
  if (which !== "measured" || !both) sheets.push({ x: now.simulated, colours: paint(now.simulated, model), side: which === "beside" ? 1 : 0 });
  if (which !== "simulated" && both) {
    sheets.push(which === "both"
      ? { x: now.measured, colours: Array(now.measured.length / 3).fill(rgb("--ink")), side: 0, lines: true }
      : { x: now.measured, colours: paint(now.measured, rgb("--measured")), side: which === "beside" ? -1 : 0 });
  }
  const size = (0.5 * sequence.reach) / (sequence.largest_force || 1);
  const arrow = (at, force, name, width, side, alpha) => ({ from: at, to: at.map((c, i) => c + size * force[i]), colour: rgb(name), width: width * sequence.reach, side, alpha });
  // Measured arrows first: they show through the simulated ones, which nearly coincide with them.
  const apart = which === "beside" ? 1 : 0;
  const arrows = [
    ...(which === "simulated" ? [] : now.arrows.map(({ at, measured }) => arrow(at, measured, "--ink", 0.006, -apart, 1))),
    ...(which === "measured" ? [] : now.arrows.map(({ at, simulated }) => arrow(at, simulated, "--c1", 0.013, apart, 0.6))),
  ];
  viewer.show(sequence, sheets, arrows, afresh);
  const unit = by === "residual" ? `${short(1e3 * largest)} mm` : short(largest);
  byId("scale").replaceChildren(...(by === "plain" ? [] : ["0", element("i", null, { style: `background: ${gradient}` }), unit]));
  byId("arrows").textContent = [which === "beside" ? "left measured, right simulated" : "",
    arrows.length ? `longest arrow of all frames ${short(sequence.largest_force)} N` : ""].filter(Boolean).join("; ");
}

function step(by) {
  showFrame((frame + by + sequence.frames.length) % sequence.frames.length);
}

function play(on) {
  clearInterval(timer);
  timer = on ? setInterval(() => step(1), 350) : null;
  byId("play").setAttribute("aria-pressed", String(on));
  byId("play").textContent = on ? "pause" : "play";
}

const KEYS = {
  ArrowLeft: () => viewer.orbit(-0.15, 0), ArrowRight: () => viewer.orbit(0.15, 0),
  ArrowUp: () => viewer.orbit(0, 0.12), ArrowDown: () => viewer.orbit(0, -0.12),
  "+": () => viewer.enlarge(1.2), "-": () => viewer.enlarge(1 / 1.2), 0: () => viewer.startOver(),
  ",": () => step(-1), ".": () => step(1), " ": () => play(!timer),
};

byId("view").addEventListener("keydown", (event) => {
  if (!KEYS[event.key]) return;
  event.preventDefault();
  KEYS[event.key]();
});
byId("sequence").addEventListener("change", (event) => { play(false); showSequence(event.target.value); });
for (const id of ["shapes", "colour"]) byId(id).addEventListener("change", () => showFrame(frame, id === "shapes"));
byId("frame").addEventListener("input", (event) => showFrame(+event.target.value));
byId("play").addEventListener("click", () => play(!timer));
byId("program").textContent = page.program;
byId("page").hidden = false;
byId("flat").hidden = Boolean(viewer.gl);
for (const id of ["scale", "arrows"]) byId(id).hidden = !viewer.gl;

function dress(theme) {
  document.documentElement.dataset.theme = theme;
  showFit(fit);
}
const dark = matchMedia("(prefers-color-scheme: dark)");
const preferred = () => (dark.matches ? "dark" : "light");
dark.addEventListener("change", () => dress(preferred()));
byId("theme").addEventListener("click", () => dress(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
// Print: light colours and a narrow page.
let before = null;
addEventListener("beforeprint", () => { before = document.documentElement.dataset.theme; paper = true; dress("light"); });
addEventListener("afterprint", () => { paper = false; dress(before); });
dress(preferred());
