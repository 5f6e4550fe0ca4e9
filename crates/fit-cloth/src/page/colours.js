// Colour-blind-safe palette: lines after Okabe and Ito, surfaces in viridis.
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const rgb = (name) => [1, 3, 5].map((i) => parseInt(css(name).slice(i, i + 2), 16) / 255);

const kinds = (key) => [...new Set(page.fits.map((fit) => fit[key]))];
const MODELS = kinds("model"), VARIANTS = kinds("variant");
const DASHES = [[], [12, 6], [3, 4], [12, 4, 3, 4]];
const LINES = ["solid", "dashed", "dotted", "double"];

// Colour by model, dash pattern by variant.
const colourOf = (fit) => css(`--c${MODELS.indexOf(fit.model) % 3}`);
const dashOf = (fit) => DASHES[VARIANTS.indexOf(fit.variant) % 4];
const labelOf = (fit) => (VARIANTS.length > 1 ? `${fit.model}, ${fit.variant}` : fit.model);

const VIRIDIS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"]
  .map((hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255));

// share: 0 … 1
function viridis(share) {
  const at = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1), low = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return VIRIDIS[low].map((c, i) => c + (VIRIDIS[low + 1][i] - c) * (at - low));
}

const gradient = `linear-gradient(90deg, ${VIRIDIS.map((c) => `rgb(${c.map((v) => Math.round(255 * v))})`).join(", ")})`;

// Four significant digits; a dash for no number.
function short(value) {
  if (value == null || Number.isNaN(value)) return "–";
  if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5)) return value.toExponential(3);
  return String(+value.toPrecision(4));
}
