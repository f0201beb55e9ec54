// The derivatives of outputs: a table for each, with a bar for each change in per cent.

/** The values of a derivative: one, those of both sides, or those of all pieces. */
function piecesOf(derivative) {
  if (!derivative) return [];
  const { value, left, right, between } = derivative;
  return between ?? [value, left, right].filter(one => (one ?? null) !== null);
}

function sensitivitySection(page, data) {
  const { sensitivities, at_kink } = data.report ?? {};
  if (!sensitivities) return;
  const own = section(page, "Derivatives", "sensitivity");
  for (const { output, value, unit, by, notes } of sensitivities) {
    element("h3", own, `${output} = ${inUnit(value, unit ?? "")}`);
    const words = (derivative, rounding = 0) =>
        piecesOf(derivative)
          .map(one => shown(Math.abs(one) < rounding ? 0 : one))
          .join(" or ") || "-",
      largest = Math.max(...by.flatMap(row => piecesOf(row.relative).map(Math.abs)), 1e-300);
    const made = table(
      own,
      [
        ["parameter", row => row.parameter],
        ["value#", row => (row.parameter === "nodes" ? "-" : inUnit(row.value, row.unit ?? ""))],
        ["derivative#", row => words(row.derivative)],
        ["% for 1 %#", row => words(row.relative, 1e-9)],
        ["verdict", row => row.derivative.verdict],
      ],
      by,
    );
    element("th", made.tHead.rows[0], "change in per cent for one per cent");
    by.forEach((row, i) => {
      const cell = element("td", made.tBodies[0].rows[i]);
      for (const one of piecesOf(row.relative)) {
        const line = element("div", cell, null, "share"),
          bar = element("span", line, null, one < 0 ? "below" : "above"),
          half = (50 * Math.abs(one)) / largest;
        bar.style.width = `${half}%`;
        bar.style.marginLeft = `${one < 0 ? 50 - half : 50}%`;
      }
    });
    const reasons = new Set([...(notes ?? []), ...by.map(row => row.derivative.why).filter(Boolean)]);
    reasons.forEach(reason => remark(own, `${reason}.`));
  }
  if (at_kink.length) remark(own, `Rows at a kink, or undecided by the proof: ${at_kink.join(", ")}.`);
}
