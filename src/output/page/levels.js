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
    ["no guarantee", report.reason],
    ["goal", percent(goal.total_error)],
    ["answer on the last mesh", ifGiven(report.last_mesh, mesh => `${words} ${percent(mesh.total_error.bound)}`)],
    ["mean stress", isGuaranteed && `guaranteed at most ${percent(report.mean_stress_error.bound)}`],
    [
      "contact force",
      isGuaranteed && `${inUnit(report.contact_force, units.force, 7)} of the displacement with this bound`,
    ],
    ["exact contact force", ifGiven(report.force_interval, ends => `guaranteed in ${interval(ends)} ${units.force}`)],
    ["check", isGuaranteed && `balance, signs, distances and energies agree to ${shown(report.defect, 2)}`],
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
  const guaranteed = [
    ["triangles#", level => level.triangles],
    ["unknowns#", level => level.dofs],
    ["of the stress#", level => level.stress_dofs],
    ["total error ≤#", level => percent(level.bound)],
    ["mean stress ≤#", level => percent(level.mean_stress_bound)],
    [`exact force [${units.force}]`, level => interval(level.force_interval)],
  ];
  const estimated = [
    [`elements${part}#`, level => level.elements],
    [`unknowns${part}#`, level => level.dofs],
    ["total error, estimated#", level => percent(level.total_error)],
    [`force [${units.force}]#`, level => shown(level.contact_force, 7)],
  ];
  table(own, isGuaranteed ? guaranteed : estimated, levels);
  if (still.firstChild) {
    still.firstChild.alt = "The meshes, from the first to the last";
    own.append(still);
  }
}
