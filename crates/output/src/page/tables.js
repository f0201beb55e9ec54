// The words and tables of a page. All text is inserted as text, not as HTML.

function element(name, parent, text = null, className = "") {
  const made = document.createElement(name);
  if (text !== null) made.textContent = text;
  if (className) made.className = className;
  if (parent) parent.appendChild(made);
  return made;
}

function section(host, title, id) {
  const made = element("section", host);
  made.id = id;
  element("h2", made, title);
  return made;
}

/** A soft remark. */
function remark(host, text) {
  element("p", host, text, "soft");
}

/** A field of a form; `label` is for readers who do not see it. */
function input(host, type, settings, label = null) {
  const made = Object.assign(element("input", host), { type, ...settings });
  if (label) made.setAttribute("aria-label", label);
  return made;
}

/** A button that does something. */
function pressed(host, text, act) {
  const button = Object.assign(element("button", host, text), { type: "button" });
  button.addEventListener("click", act);
  return button;
}

/** A legend: each entry has a text, and the shapes of its mark as [name, attributes] in a square of 20. */
function legendOf(host, entries) {
  const legend = element("div", host, null, "legend");
  for (const [text, ...shapes] of entries) {
    const entry = element("span", legend),
      mark = svg("svg", { viewBox: "0 0 20 20" }, entry);
    for (const [name, attributes] of shapes) svg(name, attributes, mark);
    entry.append(text);
  }
}

/** A table of items: a column is [heading, cell of an item]; one whose heading ends with # holds numbers. */
function table(host, columns, items) {
  const made = element("table", element("div", host, null, "wide")),
    head = element("tr", element("thead", made)),
    body = element("tbody", made);
  const kinds = columns.map(([heading]) => (heading.endsWith("#") ? "number" : ""));
  columns.forEach(([heading], i) => element("th", head, heading.replace(/#$/, ""), kinds[i]));
  for (const item of items) {
    const line = element("tr", body);
    columns.forEach(([, cell], i) => element("td", line, cell(item), kinds[i]));
  }
  return made;
}

/** Names with their contents; an entry without content is left out. */
function list(host, entries) {
  const made = element("dl", host);
  for (const [name, content] of entries.filter(entry => (entry[1] ?? false) !== false)) {
    element("dt", made, name);
    element("dd", made, content);
  }
}

const STATUS = {
  certified: "certified",
  not_certified: "not certified",
  unstable: "unstable: do not trust this motion",
  "beyond-small-displacements": "beyond small displacements: do not use this answer",
};

function badge(host, status) {
  if (status) element("span", host, STATUS[status] ?? status, `badge ${status === "certified" ? "good" : "bad"}`);
}

/** The first paragraph: the command and its outcome. */
function headline(page, data, summary) {
  const line = element("p", page),
    { about } = data;
  const statuses = data.sweep?.points.map(point => point.status);
  badge(line, summary?.status ?? statuses?.find(status => status !== "certified") ?? statuses?.[0]);
  line.append(` signorini ${about.command}`);
  for (const warning of summary?.warnings ?? []) element("p", page, `Warning: ${warning.message}`, "warning");
}

/** A value with its uncertainty, if it has one above rounding. */
function within(value, off, unit) {
  return off > 1e-11 * value ? `${inUnit(value, unit)} ± ${shown(off, 2)}` : inUnit(value, unit);
}

/** The width of a contact, its radius about an axis, or its area in space, with the uncertainty. */
function extentWords({ width, width_uncertainty, area, area_uncertainty, from_axis }, units) {
  return (width ?? null) !== null
    ? `${from_axis ? "radius" : "width"} ${within(width, width_uncertainty, units.length)}`
    : `area ${within(area, area_uncertainty, `${units.length}²`)}`;
}

/** The words of a value, if there is one. */
function ifGiven(value, words) {
  return (value ?? null) !== null && words(value);
}

/** The numbers of one answer. */
function contactList(host, summary, data) {
  const { contact, model } = summary,
    { estimate } = contact,
    { units } = data,
    basis = summary.force_basis ? ` ${summary.force_basis}` : "";
  const part = ofPart(data),
    aside = part && `,${part}`,
    copies = obstacleCount(contact),
    several = copies > 1 ? copies : 0;
  list(host, [
    ["method", `${summary.method}, ${counted(summary.iterations, "iteration")}${aside}`],
    ["why", summary.reason],
    [
      "symmetry",
      Boolean(summary.parts_of_whole) &&
        "method, certificate and pictures are of the meshed part; in the scene the force on an obstacle is of the whole body, loads, springs and rigid faces are of the meshed part",
    ],
    [
      "model",
      `${model.nodes ? `${counted(model.nodes, "node")}, ${counted(model.elements, "element")}, ` : ""}${counted(model.dofs, "dof")}, ${counted(model.contact_rows, "contact row")}${model.equality_rows ? `, ${counted(model.equality_rows, "equality row")}` : ""}${part}`,
    ],
    [
      "contact",
      `${counted(contact.count, "closed row")}${part}, ${several ? `on ${counted(several, "obstacle")}` : `sum of multipliers ${inUnit(contact.force, units.force, 9)}${basis}`}`,
    ],
    [
      "peak pressure",
      !several && ifGiven(contact.pressure_max, most => within(most, estimate?.pressure_uncertainty, units.pressure)),
    ],
    ["estimated extent", !several && ifGiven(estimate, known => extentWords(known, units))],
    ["contact set", data.proven && `${data.proven}${aside}`],
    ["rows of means", data.means],
    ["balance of forces", ifGiven(contact.force_balance, off => `to ${shown(off, 2)}, relative${aside}`)],
    [
      "error of the mesh",
      ifGiven(
        summary.discretisation_error,
        share => `about ${shown(100 * share, 2)} % of the energy norm, estimated from the stresses`,
      ),
    ],
    ["strain energy", ifGiven(summary.strain_energy, energy => inUnit(energy, workUnit(units)))],
  ]);
  if (!several) return;
  obstacleTable(
    host,
    contact.obstacles.map(one => [null, one]),
    units,
  );
  if (basis) remark(host, `Forces${basis}.`);
}

function workUnit({ force, length }) {
  return `${force} ${length}`.trim();
}

/** The words behind numbers of the meshed part, if planes of symmetry make it a part. */
function ofPart({ question }) {
  return question?.parts > 1 ? " of the meshed part" : "";
}

/** Number of obstacles in the whole body, mirror images included. */
function obstacleCount({ obstacles = [] }) {
  return obstacles.reduce((sum, one) => sum + one.copies, 0);
}

/** The mirror images of an obstacle, in words. */
function imagesOf({ copies }) {
  return copies === 1 ? "" : copies === 2 ? " and its mirror image" : ` and its ${copies - 1} mirror images`;
}

/** The contact of each obstacle and pair of bodies: lines of `[value, obstacle]`; the values have a column if it has a name. */
function obstacleTable(host, lines, units, name = null) {
  const flat = lines.filter(([, one]) => one.estimate?.width !== undefined),
    inPlane = flat.length > 0,
    extent = flat.every(([, one]) => one.estimate.from_axis) ? "radius" : "width",
    isPressed = lines.some(([, one]) => one.travel !== undefined);
  const columns = [
    ["obstacle", one => `${one.of}${one.on ? ` on ${one.on}` : ""}${imagesOf(one)}`],
    [`force [${units.force}]#`, one => shown(one.force)],
    ...(isPressed ? [[`travel [${units.length}]#`, one => shown(one.travel)]] : []),
    [`peak pressure [${units.pressure}]#`, one => within(one.pressure_max, one.estimate?.pressure_uncertainty, "")],
    inPlane
      ? [`estimated ${extent} [${units.length}]#`, one => within(one.estimate?.width, one.estimate?.width_uncertainty, "")]
      : [`estimated area [${units.length}²]#`, one => within(one.estimate?.area, one.estimate?.area_uncertainty, "")],
    [`mean pressure [${units.pressure}]#`, one => shown(one.pressure_mean)],
  ].map(([heading, cell]) => [heading, ([, one]) => cell(one)]);
  table(host, name ? [[name, ([value]) => value], ...columns] : columns, lines);
}

function certificateSection(page, data) {
  const { certificate } = data;
  if (!certificate) return;
  const own = section(page, `Certificate${ofPart(data)}`, "certificate");
  element(
    "p",
    own,
    `This answer is ${certificate.verdict.replace(/, each relative:$/, ": the conditions that decide, recomputed from the problem, hold to that, each relative to its own scale.")}`.replace(
      /is NOT (.*): the conditions that decide, recomputed from the problem, hold to that, each relative to its own scale\./,
      "is NOT $1. The conditions, recomputed from the problem, each relative to its own scale:",
    ),
  );
  const columns = ["condition", "formula", "value#"].map((heading, i) => [heading, condition => condition[i]]);
  if (certificate.conditions.length) table(own, columns, certificate.conditions);
  for (const note of certificate.notes) remark(own, `${note[0].toUpperCase()}${note.slice(1)}.`);
  remark(
    own,
    "The energy error bounds the distance of the displacement from the exact solution of the discrete problem. It says nothing of the mesh.",
  );
}

function resultantSection(page, summary, { units }) {
  if (!summary?.resultants?.length) return;
  const own = section(page, "Resultants", "resultants"),
    largest = Math.max(...summary.resultants.flatMap(resultant => resultant.force.map(Math.abs))),
    moved = ({ travel, motion }) =>
      ifGiven(travel, way => `travel ${inUnit(way, units.length)}`) || vectorShown(motion?.displacement, units.length);
  table(
    own,
    [
      ["of", ({ of, on, rule }) => `${of}${on ? ` on ${on}` : ""}${rule ? `, rule ${rule}` : ""}`],
      ["nodes#", resultant => resultant.nodes],
      [`force [${units.force}]`, resultant => vectorShown(resultant.force, "", 5, largest)],
      [`moment about the origin [${workUnit(units)}]`, ({ moment }) => (moment.length ? vectorShown(moment, "") : "-")],
      [`centre [${units.length}]`, ({ centre }) => vectorShown(centre, "")],
      ["moved", moved],
    ],
    summary.resultants,
  );
  remark(own, `Forces on the body${summary.force_basis ? `, ${summary.force_basis}` : ""}.`);
}

function segmentSection(page, summary, data) {
  if (!summary?.segments?.length) return;
  const { units } = data;
  table(
    section(page, `Contact segments${ofPart(data)}`, "segments"),
    [
      ["obstacle", segment => `obstacles[${segment.obstacle}]`],
      ["closed nodes#", segment => segment.nodes.length],
      [`force [${units.force}]`, segment => vectorShown(segment.force, "")],
      [`peak pressure [${units.pressure}]#`, segment => shown(segment.pressure_max)],
      ["extent", segment => extentWords(segment, units)],
      [`ends [${units.length}]`, ({ ends }) => ends?.map(end => vectorShown(end, "")).join(" to ") ?? "-"],
    ],
    summary.segments,
  );
}

function comparisonSection(page, data) {
  const { methods, agreement } = data.report ?? {};
  if (!methods) return;
  const own = section(page, "Three methods", "methods"),
    { units } = data,
    part = ofPart(data);
  table(
    own,
    [
      ["method", ({ method }) => method],
      ["status", ({ status }) => STATUS[status]],
      [`iterations${part}#`, ({ iterations }) => shown(iterations)],
      [`closed${part}#`, ({ contact }) => contact.count],
      [`force [${units.force}]#`, ({ contact }) => shown(contact.force, 10)],
      [`peak pressure [${units.pressure}]#`, ({ contact }) => shown(contact.pressure_max)],
      [`energy error${part} ≤#`, ({ certificate }) => shown(certificate.energy_error_bound, 2)],
    ],
    methods,
  );
  element(
    "p",
    own,
    agreement.exact_methods
      ? "The QP and the active set agree, both certified."
      : "The QP and the active set do NOT agree, or are not both certified.",
  );
}

/** Version, input and machine, and the accuracy of the page. */
function aboutSection(page, data, notes) {
  const own = section(page, "About this page", "about"),
    { about } = data;
  list(own, [
    ["program", `signorini ${about.version}`],
    ["command", about.command],
    ["input", about.input],
    ["SHA-256 of the input", about.sha256 ?? "none: it came by a pipe"],
    ["threads", about.threads === null ? "chosen by the program" : String(about.threads)],
    ["machine", about.machine],
  ]);
  for (const note of notes) remark(own, note);
}
