// An error against the continuum that falls from mesh to mesh.

function levelsSection(page, data, still) {
  const { report, units, colours } = data,
    { levels, goal } = report,
    own = section(page, "The error against the continuum", "levels"),
    percent = share => `${shown(100 * share, 3)} %`,
    interval = ends => (ends ? ends.map(end => shown(end, 8)).join(" to ") : "-");
  list(own, [
    ["total error", `guaranteed at most ${percent(report.total_error.bound)} of the displacement, in the energy norm`],
    ["goal", percent(goal.total_error)],
    ["mean stress", `guaranteed at most ${percent(report.mean_stress_error.bound)}`],
    ["contact force", `${inUnit(report.contact_force, units.force, 7)} of this answer`],
    [
      "exact contact force",
      report.force_interval ? `guaranteed in ${interval(report.force_interval)} ${units.force}` : null,
    ],
    ["check", `balance, signs, distances and energies agree to ${shown(report.defect, 2)}`],
  ]);
  const line = (name, value, index) => ({
    name,
    colour: colours.lines[index],
    marks: true,
    focus: true,
    points: levels.map(level => [
      level.dofs,
      value(level),
      `${counted(level.triangles, "triangle")}, ${counted(level.dofs, "unknown")}\n${name} ${percent(value(level))}`,
    ]),
  });
  const series = [line("displacement", level => level.bound, 0), line("mean stress", level => level.mean_stress_bound, 1)];
  const { dofs: first } = levels[0],
    { dofs: last } = levels.at(-1);
  const asked = {
    name: "goal",
    colour: "var(--soft)",
    dash: "6 5",
    points: [first, last].map(dofs => [dofs, goal.total_error, ""]),
  };
  plotted(own, {
    label: "Guaranteed error over the unknowns",
    x: { name: "unknowns of the displacement", log: true },
    y: { name: "guaranteed error, relative", log: true },
    series: [asked, ...series],
    height: 360,
  });
  keyOf(own, [...series, asked]);
  table(
    own,
    ["triangles#", "unknowns#", "of the stress#", "total error ≤#", "mean stress ≤#", `exact force [${units.force}]`],
    levels.map(level => [
      String(level.triangles),
      String(level.dofs),
      String(level.stress_dofs),
      percent(level.bound),
      percent(level.mean_stress_bound),
      interval(level.force_interval),
    ]),
  );
  still.firstChild.alt = "The meshes, from the first to the last";
  own.append(still);
}
