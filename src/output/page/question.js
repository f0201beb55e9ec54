// The question: the body with its supports, loads and obstacles.

function questionSection(page, data, shape, summary) {
  const own = section(page, "The question", "question"),
    { question, units } = data,
    box = element("div", own, null, "view");
  const loads = summary?.resultants?.find(resultant => resultant.of === "loads");
  const view = new View(box, shape, {
    table: data.colours.field.map(channels),
    label: "The body with its supports, loads and obstacles before anything has moved",
    paint: (view, brush) => {
      if (shape.flat)
        question.obstacles.forEach(obstacle => obstacle.outline && paintOutline(view, brush, obstacle));
      paintHolds(view, brush, question, shape.dimension);
      paintLoads(view, brush, question.loads, loads, shape.dimension);
      paintGap(view, brush, data.rows, units.length, shape.dimension);
      paintScale(view, brush, units.length);
    },
  });
  addPatches(view, data);
  view.mesh = shape.lines.length < MOST_LINES;
  if (!shape.flat) {
    const held = some(question.fixed.length, 4000).map(i => question.fixed[i]),
      rigid = some(question.rigid.length, 4000).map(i => question.rigid[i]);
    view.setMarks([...held, ...rigid], [...held.map(() => 4), ...rigid.map(() => 5)]);
  }
  if (shape.flat) {
    const [low, high] = [[...shape.low], [...shape.high]];
    for (const { approach } of question.obstacles)
      for (let k = 0; k < 2; k++) (approach[k] < 0 ? low : high)[k] += 0.1 * shape.size * approach[k];
    view.window = [low, high];
  }
  const legend = element("div", own, null, "legend");
  const entry = (text, name, attributes) => {
    const span = element("span", legend);
    svg(name, attributes, svg("svg", { viewBox: "0 0 20 20" }, span));
    span.append(text);
  };
  if (question.fixed.length)
    entry("held in all directions", "rect", { x: 4, y: 4, width: 12, height: 12, fill: "var(--held)" });
  if (question.guided.vertices.length)
    entry("held across the plate", "rect", { x: 1, y: 8, width: 18, height: 4, fill: "var(--held)" });
  if (question.springs.vertices.length)
    entry("spring", "path", {
      d: "M1 10H4L6 5 9 15 12 5 15 15 17 10H19",
      stroke: "var(--spring)",
      "stroke-width": 2,
      fill: "none",
    });
  if (question.rigid.length) entry("rigid face", "rect", { x: 5, y: 5, width: 10, height: 10, fill: "var(--rigid)" });
  if (question.loads.vertices.length || question.loads.inside)
    entry("load", "path", {
      d: "M1 10H12M12 4 19 10 12 16Z",
      stroke: "var(--load)",
      "stroke-width": 2,
      fill: "var(--load)",
    });
  if (question.obstacles.some(obstacle => !obstacle.is_body))
    entry("obstacle", "rect", { x: 2, y: 4, width: 16, height: 12, fill: "var(--solid)" });
  list(own, [
    [
      "gap",
      question.obstacles.some(({ force }) => force === undefined)
        ? `${inUnit(question.gap, units.length)}: the shift of every obstacle ${question.obstacles.some(({ force }) => force !== undefined) ? "without a force " : ""}along its approach direction, negative towards the body`
        : null,
    ],
    ...question.obstacles.map(({ boundary, approach, is_body, force }, index) => [
      `obstacles[${index}]`,
      `${is_body ? "another body" : "rigid"}, faces the boundary ${boundary} in the direction ${vectorShown(approach.slice(0, shape.dimension), "")}${force === undefined ? "" : `, pressed by ${inUnit(force, units.force)}`}`,
    ]),
    ["loads", loads ? `${vectorShown(loads.force, units.force)} in all` : null],
    ["supports", supportWords(question, shape.dimension, ofPart(data))],
    ["springs", springWords(question.springs, shape.dimension, ofPart(data))],
    ["rigid faces", question.rigid.length ? `${counted(question.rigid.length, "node")} that move as one body${ofPart(data)}` : null],
  ]);
  return view;
}

function springWords({ vertices }, dimension, part) {
  if (!vertices.length) return null;
  return `at ${counted(new Set(vertices).size / (dimension === 1 ? 2 : 1), "node")} of the boundary${part}`;
}

function supportWords({ fixed, guided }, dimension, part) {
  const parts = [];
  if (fixed.length)
    parts.push(`${counted(dimension === 1 ? fixed.length / 2 : fixed.length, "node")} held in all directions`);
  if (guided.vertices.length) parts.push(`${counted(guided.vertices.length, "direction")} of nodes held`);
  return parts.length ? `${parts.join(", ")}${part && `,${part}`}` : "none";
}
