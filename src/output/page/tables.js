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

/** A table; a column whose heading ends with # holds numbers. */
function table(host, headings, rows) {
  const wide = element("div", host, null, "wide"),
    made = element("table", wide),
    head = element("tr", element("thead", made));
  const isNumber = headings.map(heading => heading.endsWith("#"));
  headings.forEach((heading, i) => element("th", head, heading.replace(/#$/, ""), isNumber[i] ? "number" : ""));
  const body = element("tbody", made);
  for (const row of rows) {
    const line = element("tr", body);
    row.forEach((cell, i) => element("td", line, cell, isNumber[i] ? "number" : ""));
  }
  return made;
}

function list(host, entries) {
  const made = element("dl", host);
  for (const [name, content] of entries.filter(entry => entry[1] !== null && entry[1] !== undefined)) {
    element("dt", made, name);
    element("dd", made, content);
  }
  return made;
}

const STATUS = {
  certified: "certified",
  not_certified: "not certified",
  unstable: "unstable: do not trust this motion",
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

/** The numbers of one answer. */
function contactList(host, summary, data) {
  const { contact, model } = summary,
    { units } = data,
    basis = summary.force_basis ? ` ${summary.force_basis}` : "";
  const estimate = contact.estimate,
    part = ofPart(data),
    copies = obstacleCount(contact),
    several = copies > 1 ? copies : 0;
  list(host, [
    ["method", `${summary.method}, ${counted(summary.iterations, "iteration")}${part && `,${part}`}`],
    ["why", summary.reason],
    [
      "symmetry",
      summary.parts_of_whole
        ? "method, certificate and pictures are of the meshed part; in the scene the force on an obstacle is of the whole body, loads, springs and rigid faces are of the meshed part"
        : null,
    ],
    [
      "model",
      `${model.nodes ? `${counted(model.nodes, "node")}, ${counted(model.elements, "element")}, ` : ""}${counted(model.dofs, "dof")}, ${counted(model.contact_rows, "contact row")}${part}`,
    ],
    [
      "contact",
      `${counted(contact.count, "closed row")}${part}, ${several ? `on ${counted(several, "obstacle")}` : `sum of multipliers ${inUnit(contact.force, units.force, 9)}${basis}`}`,
    ],
    [
      "peak pressure",
      several || contact.pressure_max === undefined
        ? null
        : estimate
          ? within(contact.pressure_max, estimate.pressure_uncertainty, units.pressure)
          : inUnit(contact.pressure_max, units.pressure),
    ],
    [
      "estimated extent",
      several || !estimate
        ? null
        : estimate.width !== undefined
          ? `width ${within(estimate.width, estimate.width_uncertainty, units.length)}`
          : `area ${within(estimate.area, estimate.area_uncertainty, `${units.length}²`)}`,
    ],
    ["contact set", data.proven && `${data.proven}${part && `,${part}`}`],
    [
      "balance of forces",
      contact.force_balance === undefined ? null : `to ${shown(contact.force_balance, 2)}, relative${part && `,${part}`}`,
    ],
    [
      "error of the mesh",
      summary.discretisation_error === undefined || summary.discretisation_error === null
        ? null
        : `about ${shown(100 * summary.discretisation_error, 2)} % of the energy norm, estimated from the stresses`,
    ],
    [
      "strain energy",
      summary.strain_energy === undefined
        ? null
        : inUnit(summary.strain_energy, `${units.force} ${units.length}`.trim()),
    ],
  ]);
  if (!several) return;
  obstacleTable(
    host,
    contact.obstacles.map(one => [null, one]),
    units,
  );
  if (basis) element("p", host, `Forces${basis}.`, "soft");
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
  const inPlane = lines.some(([, one]) => one.estimate?.width !== undefined),
    pressed = lines.some(([, one]) => one.travel !== undefined);
  const columns = [
    ...(name ? [[name, (_, value) => value]] : []),
    ["obstacle", one => `${one.of}${one.on ? ` on ${one.on}` : ""}${imagesOf(one)}`],
    [`force [${units.force}]#`, one => shown(one.force)],
    ...(pressed ? [[`travel [${units.length}]#`, one => shown(one.travel)]] : []),
    [`peak pressure [${units.pressure}]#`, one => within(one.pressure_max, one.estimate?.pressure_uncertainty, "")],
    inPlane
      ? [`estimated width [${units.length}]#`, one => within(one.estimate?.width, one.estimate?.width_uncertainty, "")]
      : [`estimated area [${units.length}²]#`, one => within(one.estimate?.area, one.estimate?.area_uncertainty, "")],
    [`mean pressure [${units.pressure}]#`, one => shown(one.pressure_mean)],
  ];
  table(
    host,
    columns.map(column => column[0]),
    lines.map(([value, one]) => columns.map(column => column[1](one, value))),
  );
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
  if (certificate.conditions.length) table(own, ["condition", "formula", "value#"], certificate.conditions);
  for (const note of certificate.notes) element("p", own, `${note[0].toUpperCase()}${note.slice(1)}.`, "soft");
  element(
    "p",
    own,
    "The energy error bounds the distance of the displacement from the exact solution of the discrete problem. It says nothing of the mesh.",
    "soft",
  );
}

function resultantSection(page, summary, { units }) {
  if (!summary?.resultants?.length) return;
  const own = section(page, "Resultants", "resultants"),
    largest = Math.max(...summary.resultants.flatMap(resultant => resultant.force.map(Math.abs))),
    moment = `${units.force} ${units.length}`.trim();
  table(
    own,
    [
      "of",
      "nodes#",
      `force [${units.force}]`,
      `moment about the origin [${moment}]`,
      `centre [${units.length}]`,
      "moved",
    ],
    summary.resultants.map(resultant => [
      `${resultant.of}${resultant.on ? ` on ${resultant.on}` : ""}${resultant.rule ? `, rule ${resultant.rule}` : ""}`,
      String(resultant.nodes),
      vectorShown(resultant.force, "", 5, largest),
      resultant.moment.length ? vectorShown(resultant.moment, "") : "-",
      resultant.centre ? vectorShown(resultant.centre, "") : "-",
      resultant.travel !== undefined
        ? `travel ${inUnit(resultant.travel, units.length)}`
        : resultant.motion
          ? vectorShown(resultant.motion.displacement, units.length)
          : "-",
    ]),
  );
  element("p", own, `Forces on the body${summary.force_basis ? `, ${summary.force_basis}` : ""}.`, "soft");
}

function segmentSection(page, summary, data) {
  if (!summary?.segments?.length) return;
  const own = section(page, `Contact segments${ofPart(data)}`, "segments"),
    { units } = data;
  table(
    own,
    [
      "obstacle",
      "closed nodes#",
      `force [${units.force}]`,
      `peak pressure [${units.pressure}]#`,
      "extent",
      `ends [${units.length}]`,
    ],
    summary.segments.map(segment => [
      `obstacles[${segment.obstacle}]`,
      String(segment.nodes.length),
      vectorShown(segment.force, ""),
      shown(segment.pressure_max),
      segment.width !== undefined && segment.width !== null
        ? `width ${within(segment.width, segment.width_uncertainty, units.length)}`
        : `area ${within(segment.area, segment.area_uncertainty, `${units.length}²`)}`,
      segment.ends ? segment.ends.map(end => vectorShown(end, "")).join(" to ") : "-",
    ]),
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
      "method",
      "status",
      `iterations${part}#`,
      `closed${part}#`,
      `force [${units.force}]#`,
      `peak pressure [${units.pressure}]#`,
      `energy error${part} ≤#`,
    ],
    methods.map(method => [
      method.method,
      STATUS[method.status],
      shown(method.iterations),
      String(method.contact.count),
      shown(method.contact.force, 10),
      shown(method.contact.pressure_max),
      shown(method.certificate.energy_error_bound, 2),
    ]),
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
    ["threads", String(about.threads)],
    ["machine", about.machine],
  ]);
  for (const note of notes) element("p", own, note, "soft");
}
