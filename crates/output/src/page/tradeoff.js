// Work and precision of many methods.

function tradeoffSection(page, data, still) {
  const { report, colours } = data,
    own = section(page, "Work and precision", "tradeoff"),
    ofMotion = report.points.some(point => "scheme" in point);
  own.append(still);
  if (report.of_meshed_part) remark(own, "All numbers but the error of the mesh are of the meshed part.");
  if (still.children.length) element("h3", own, "Every measured point, with its values under the pointer");
  const error = point => Math.max(ofMotion ? point.displacement_error : point.energy_error, 1e-16),
    placed = point => [point.seconds, error(point), wordsOf(point)];
  const panels = ofMotion
    ? [[`${counted(report.dofs, "dof")}`, report.points]]
    : report.meshes.map((mesh, index) => [
        `${counted(mesh.dofs, "dof")}, ${counted(mesh.contact_rows, "contact row")}`,
        report.points.filter(point => point.mesh === index),
      ]);
  for (const [title, points] of panels) {
    element("h3", own, title);
    const names = [...new Set(points.map(nameOf))],
      methods = [...new Set(names.map(methodOf))];
    const series = names.map(name => ({
      name,
      colour: colours.lines[methods.indexOf(methodOf(name)) % colours.lines.length],
      dash: name.includes("all dofs") ? "6 4" : "none",
      marks: true,
      focus: true,
      points: points.filter(point => nameOf(point) === name).map(placed),
    }));
    const front = points.filter(point => point.best).sort((a, b) => a.seconds - b.seconds),
      best = { name: "Pareto front", colour: "var(--soft)", dash: "6 5", points: front.map(placed) };
    plotted(own, {
      label: `Error over time, ${title}`,
      x: { name: "time [s]", log: true },
      y: { name: ofMotion ? "displacement error, relative" : "energy error, relative", log: true },
      series: [best, ...series],
      height: 360,
    });
    keyOf(own, [...series, best]);
    const more = element("details", own);
    element("summary", more, `${counted(points.length, "measured point")} as a table`);
    table(
      more,
      [
        ["method", nameOf],
        ["seconds#", point => shown(point.seconds, 4)],
        ["error#", point => shown(error(point), 3)],
        ["best", point => (point.best ? "on the front" : "")],
      ],
      points,
    );
  }
}

/** The method of a name, whatever it works on. */
function methodOf(name) {
  return name.replace(/, (contact|all) dofs.*$/, "");
}

function nameOf(point) {
  return point.scheme ?? `${point.method}, ${point.condensed ? "contact" : "all"} dofs`;
}

function wordsOf(point) {
  if (point.scheme)
    return `${point.scheme}, step ${shown(point.step, 4)}\n${shown(point.seconds, 4)} s, displacement error ${shown(point.displacement_error, 3)}\nenergy change ${shown(point.energy_change, 2)}`;
  return [
    `${nameOf(point)}${point.knob === null ? "" : `, setting ${shown(point.knob, 2)}`}`,
    `${shown(point.seconds, 4)} s`,
    `energy error ${shown(point.energy_error, 3)}, bound ${shown(point.energy_error_bound, 3)}`,
    `force error ${shown(point.force_error, 3)}`,
    counted(point.rows_wrong, "misclassified row"),
  ].join("\n");
}
