// An error against the continuum that falls from mesh to mesh.

function levelsSection(page, data, still) {
  const { report, units, colours } = data,
    { levels, goal } = report,
    own = section(page, "The error against the continuum", "levels"),
    part = ofPart(data),
    // A level without a guarantee has the estimated error of its elements.
    isGuaranteed = report.total_error.guaranteed,
    words = isGuaranteed ? "guaranteed at most" : "estimated",
    cells = level => (isGuaranteed ? counted(level.triangles, "triangle") : counted(level.elements, "element")),
    error = level => level.bound ?? level.total_error,
    percent = share => `${shown(100 * share, 3)} %`,
    interval = ends => (ends ? ends.map(end => shown(end, 8)).join(" to ") : "-");
  list(own, [
    ["total error", `${words} ${percent(report.total_error.bound)} of the displacement, in the energy norm`],
    ["no guarantee", report.reason ?? null],
    ["goal", percent(goal.total_error)],
    ["answer on the last mesh", report.last_mesh ? `${words} ${percent(report.last_mesh.total_error.bound)}` : null],
    ["mean stress", isGuaranteed ? `guaranteed at most ${percent(report.mean_stress_error.bound)}` : null],
    ["contact force", isGuaranteed ? `${inUnit(report.contact_force, units.force, 7)} of the displacement with this bound` : null],
    [
      "exact contact force",
      report.force_interval ? `guaranteed in ${interval(report.force_interval)} ${units.force}` : null,
    ],
    ["check", isGuaranteed ? `balance, signs, distances and energies agree to ${shown(report.defect, 2)}` : null],
  ]);
  const line = (name, value, index) => ({
    name,
    colour: colours.lines[index],
    marks: true,
    focus: true,
    points: levels.map(level => [
      level.dofs,
      value(level),
      `${cells(level)}, ${counted(level.dofs, "unknown")}${part}\n${name} ${percent(value(level))}`,
    ]),
  });
  const series = [line("displacement", error, 0)];
  if (isGuaranteed) series.push(line("mean stress", level => level.mean_stress_bound, 1));
  const { dofs: first } = levels[0],
    { dofs: last } = levels.at(-1);
  const asked = {
    name: "goal",
    colour: "var(--soft)",
    dash: "6 5",
    points: [first, last].map(dofs => [dofs, goal.total_error, ""]),
  };
  plotted(own, {
    label: `${isGuaranteed ? "Guaranteed" : "Estimated"} error over the unknowns${part}`,
    x: { name: `unknowns of the displacement${part}`, log: true },
    y: { name: `${isGuaranteed ? "guaranteed" : "estimated"} error, relative`, log: true },
    series: [asked, ...series],
    height: 360,
  });
  keyOf(own, [...series, asked]);
  if (isGuaranteed)
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
  else
    table(
      own,
      [`elements${part}#`, `unknowns${part}#`, "total error, estimated#", `force [${units.force}]#`],
      levels.map(level => [
        String(level.elements),
        String(level.dofs),
        percent(level.total_error),
        shown(level.contact_force, 7),
      ]),
    );
  if (still.firstChild) {
    still.firstChild.alt = "The meshes, from the first to the last";
    own.append(still);
  }
}
