// An error against the continuum that falls from mesh to mesh.

function levelsSection(page, data, still) {
  const { report, units, colours } = data,
    { levels, goal } = report,
    own = section(page, "The error against the continuum", "levels"),
    part = ofPart(data),
    // A level without a guarantee has the estimated error of its elements.
    isGuaranteed = report.total_error.guaranteed,
    words = isGuaranteed ? "guaranteed at most" : "estimated",
    cells = level => counted(level.elements, "element"),
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
  const told = (name, [dofs, value]) => {
    const level = levels.find(level => level.dofs === dofs);
    return `${cells(level)}, ${counted(dofs, "unknown")}${part}\n${name} ${percent(value)}`;
  };
  const [{ x, ...plot }] = data.plots;
  dataPlot(own, { x: { ...x, name: `${x.name}${part}` }, ...plot }, colours, { words: told, height: 360 });
  const guaranteed = [
    ["elements#", level => level.elements],
    ["unknowns#", level => level.dofs],
    ["of the stress#", level => level.stress_dofs],
    ["total error ≤#", level => percent(level.total_error)],
    ["mean stress ≤#", level => percent(level.mean_stress_error)],
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
