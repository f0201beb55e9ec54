// Numbers as text, colours of values, stresses from their components.

/** A number with this many digits, without trailing zeros. */
function shown(value, digits = 6) {
  if (value === null || value === undefined || Number.isNaN(value)) return "-";
  if (!Number.isFinite(value)) return value > 0 ? "infinite" : "-infinite";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits)));
  return value
    .toExponential(digits - 1)
    .replace(/\.?0+e/, "e")
    .replace("e+", "e");
}

/** A quantity with its unit. */
function titled({ name, unit }) {
  return `${name}${unit && ` [${unit}]`}`;
}

function inUnit(value, unit, digits) {
  return `${shown(value, digits)} ${unit}`.trim();
}

/** A vector; components that are rounding beside the largest are shown as the zeros that they stand for. */
function vectorShown(values, unit, digits = 5, largest = Math.max(...(values ?? []).map(Math.abs))) {
  if (!values) return "-";
  const parts = values.map(value => shown(Math.abs(value) <= 1e-11 * largest ? 0 : value, digits));
  return `${parts.length === 1 ? parts[0] : `(${parts.join(", ")})`} ${unit}`.trim();
}

function counted(count, noun) {
  return `${count} ${noun}${count === 1 ? "" : "s"}`;
}

/** Red, green and blue, 0 to 1, of a colour as #rrggbb. */
function channels(hex) {
  return [1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16) / 255);
}

/** The colour of a share of the range, as [r, g, b] from 0 to 1. */
function colourAt(table, share) {
  const place = clamped(Number.isFinite(share) ? share : 0, 0, 1) * (table.length - 1),
    below = Math.min(Math.floor(place), table.length - 2),
    part = place - below;
  return table[below].map((low, channel) => between(low, table[below + 1][channel], part));
}

/** Round values that lie between two others. */
function ticks(low, high, most) {
  if (!(high > low)) return [low];
  const raw = (high - low) / Math.max(most, 1),
    power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(factor => factor * power).find(candidate => candidate >= raw * 0.999999);
  const values = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++)
    values.push(Number((k * step).toPrecision(12)));
  return values;
}

/** The quantities for colouring a body. */
function quantitiesOf({ fields, units }) {
  const named = ({ name, words, symbol, unit }) => [name, { name: symbol ? `${symbol}, ${words}` : words, unit }];
  return {
    ...Object.fromEntries(fields.map(named)),
    pressure: { name: "contact pressure p", unit: units.pressure },
    displacement: { name: "size of the displacement |u|", unit: units.length },
    none: { name: "none", unit: "" },
  };
}

/** Fields of a vertex that are computed from the stress, which is exact between two answers. */
const FROM_STRESS = { sigma_2: secondPrincipal, von_mises: vonMises };

/** Components xx, yy, zz, xy and, in space, yz and zx begin at `at`. */
function vonMises(s, at, n) {
  const [xx, yy, zz, xy] = [s[at], s[at + 1], s[at + 2], s[at + 3]];
  const [yz, zx] = n === 6 ? [s[at + 4], s[at + 5]] : [0, 0];
  const normal = ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2;
  return Math.sqrt(normal + 3 * (xy * xy + yz * yz + zx * zx));
}

/** The second principal stress: in the plane the smaller one, in space the middle one. */
function secondPrincipal(s, at, n) {
  const [xx, yy, zz, xy] = [s[at], s[at + 1], s[at + 2], s[at + 3]];
  if (n !== 6) return (xx + yy) / 2 - Math.hypot((xx - yy) / 2, xy);
  const [yz, zx] = [s[at + 4], s[at + 5]];
  const mean = (xx + yy + zz) / 3,
    [a, b, c] = [xx - mean, yy - mean, zz - mean];
  const size = Math.sqrt((a * a + b * b + c * c + 2 * (xy * xy + yz * yz + zx * zx)) / 6);
  if (!(size > 0)) return mean;
  const determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx);
  const angle = Math.acos(Math.min(Math.max(determinant / (2 * size ** 3), -1), 1)) / 3;
  const largest = mean + 2 * size * Math.cos(angle),
    smallest = mean + 2 * size * Math.cos(angle + (2 * Math.PI) / 3);
  return 3 * mean - largest - smallest;
}
