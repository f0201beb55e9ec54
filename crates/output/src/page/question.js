// The question: the body with its supports, loads and obstacles.

function questionSection(page, data, shape, summary) {
  const own = section(page, "The question", "question"),
    { question, units } = data,
    { fixed, guided, springs, rigid, obstacles } = question,
    loads = summary?.resultants?.find(resultant => resultant.of === "loads");
  const view = bodyView(element("div", own, null, "view"), data, shape, {
    label: "The body with its supports, loads and obstacles before anything has moved",
    paint: (view, brush) => {
      if (shape.flat) obstacles.forEach(obstacle => obstacle.outline && paintOutline(view, brush, obstacle));
      paintHolds(view, brush, question);
      paintLoads(view, brush, question.loads, loads);
      paintGap(view, brush, data.rows, units.length);
      paintScale(view, brush, units.length);
    },
  });
  view.window = windowOf(shape, obstacles, shape);
  if (!shape.flat) {
    const [held, stiff] = [fixed, rigid].map(vertices => some(vertices.length, 4000).map(i => vertices[i]));
    view.setMarks([...held, ...stiff], [...held.map(() => 4), ...stiff.map(() => 5)]);
  }
  const isRigid = obstacles.some(obstacle => !obstacle.is_body),
    isLoaded = question.loads.vertices.length > 0 || question.loads.inside,
    block = (x, y, width, height, colour) => ["rect", { x, y, width, height, fill: `var(--${colour})` }],
    line = (d, colour, fill) => ["path", { d, stroke: `var(--${colour})`, "stroke-width": 2, fill }];
  const all = [
    [fixed.length, "held in all directions", block(4, 4, 12, 12, "held")],
    [guided.vertices.length, "held across the plate", block(1, 8, 18, 4, "held")],
    [springs.vertices.length, "spring", line("M1 10H4L6 5 9 15 12 5 15 15 17 10H19", "spring", "none")],
    [rigid.length, "rigid face", block(5, 5, 10, 10, "rigid")],
    [isLoaded, "load", line("M1 10H12M12 4 19 10 12 16Z", "load", "var(--load)")],
    [isRigid, "obstacle", block(2, 4, 16, 12, "solid")],
  ];
  const entries = all.filter(([isThere]) => isThere).map(([, ...entry]) => entry);
  legendOf(own, entries);
  list(own, [
    [
      "gap",
      obstacles.some(({ force }) => force === undefined) &&
        `${inUnit(question.gap, units.length)}: the shift of every obstacle ${obstacles.some(({ force }) => force !== undefined) ? "without a force " : ""}along its approach direction, negative towards the body`,
    ],
    ...obstacles.map(({ boundary, approach, is_body, force, inertia }, index) => [
      `obstacles[${index}]`,
      `${is_body ? "another body" : "rigid"}, faces the boundary ${boundary} in the direction ${vectorShown(approach.slice(0, shape.dimension), "")}${inertia === undefined ? "" : `, of mass ${shown(inertia[0])}, starts with the speed ${shown(inertia[1])}`}${force === undefined ? "" : `, pressed by ${inUnit(force, units.force)}`}`,
    ]),
    ["loads", ifGiven(loads, ({ force }) => `${vectorShown(force, units.force)} in all`)],
    ["supports", supportWords(question, shape.dimension, ofPart(data))],
    ["springs", springWords(springs, shape.dimension, ofPart(data))],
    ["rigid faces", rigid.length > 0 && `${counted(rigid.length, "node")} that move as one body${ofPart(data)}`],
  ]);
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
