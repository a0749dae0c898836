// A sweep: success first, then errors over what was varied, as bands, boxes, a map of two fields, and a table.
const QUANTITIES = [...AXES, "translation", "rotation"];
const quantityUnit = (q) => (q < 3 || q === 6 ? "cm" : "deg");
const KINDS = ["|error|", "|error| / sigma", "stated sigma"];
const SUBJECTS = [["camera", "cameras in the robot"], ["pair", "between cameras"]];
const BANDS = [["middle half", 0.25, 0.75], ["90 %", 0.05, 0.95], ["none", 0.5, 0.5]];
const methodColor = (index) => cameraColor(index);

const lengthOf = (list, first) => (list.slice(first, first + 3).some((v) => v === null) ? null : Math.hypot(...list.slice(first, first + 3)));
const part = (list, q) => (list === null ? null : q < 6 ? list[q] : lengthOf(list, q === 6 ? 0 : 3));
function valueOf(rows, i, q, kind) {
  const error = part(rows.error[i], q), sigma = part(rows.sigma[i], q);
  if (kind === 2) return sigma;
  if (error === null) return null;
  return kind === 0 ? Math.abs(error) : sigma > 0 ? Math.abs(error) / sigma : null;
}

// Values and counts of each (level of x, method) among the tasks that the filters leave.
class SweepView {
  constructor(data) {
    this.data = data;
    this.subjects = SUBJECTS.filter(([kind]) => data.subjects.some((name) => name.startsWith(kind + ":")));
    const free = data.axes.map((_, i) => i).filter((i) => !data.axes[i].pooled && data.axes[i].levels.length > 1);
    this.choices = free.length ? free : data.axes.map((_, i) => i);
    const numeric = this.choices.find((i) => this.isNumeric(i));
    Object.assign(this, { x: numeric ?? this.choices[0] ?? -1, q: 6, kind: 0, subject: 0, band: 0, log: true, logX: false, fixed: {} });
  }
  isNumeric(axis) { return this.data.axes[axis].levels.every((label) => label !== "" && isFinite(Number(label))); }
  levels() { return this.x < 0 ? ["all"] : this.data.axes[this.x].levels; }
  taskIsIn(task) { return Object.entries(this.fixed).every(([axis, level]) => level === null || Number(axis) === this.x || this.data.tasks[task][axis] === level); }
  gather(place = (task) => (this.x < 0 ? 0 : this.data.tasks[task][this.x]), places = this.levels().length) {
    const { rows, methods, tasks, subjects } = this.data, prefix = this.subjects[this.subject][0] + ":";
    const wanted = subjects.map((name) => name.startsWith(prefix));
    const cells = Array.from({ length: places }, () => methods.map(() => ({ values: [], answered: 0, tasks: 0, open: new Map() })));
    tasks.forEach((_, t) => { if (this.taskIsIn(t)) for (const cell of cells[place(t)]) cell.tasks++; });
    for (let i = 0; i < rows.task.length; ++i) {
      const t = rows.task[i];
      if (!wanted[rows.subject[i]] || !this.taskIsIn(t)) continue;
      const cell = cells[place(t)][rows.method[i]], value = valueOf(rows, i, this.q, this.kind), error = valueOf(rows, i, this.q, 0);
      if (value !== null) cell.values.push(value);
      cell.open.set(t, (cell.open.get(t) ?? true) && error !== null);
    }
    for (const row of cells) for (const cell of row) {
      cell.values.sort((a, b) => a - b);
      for (const complete of cell.open.values()) if (complete) cell.answered++;
    }
    return cells;
  }
  unit() { return this.kind === 1 ? "" : quantityUnit(this.q); }
  title() { return `${this.kind === 0 ? "|error|" : KINDS[this.kind]} of ${QUANTITIES[this.q]}${this.unit() ? ` [${this.unit()}]` : ""}`; }
}
const sortedQuantile = (sorted, q) => {
  if (!sorted.length) return null;
  const at = q * (sorted.length - 1), low = Math.floor(at), high = Math.min(sorted.length - 1, low + 1);
  return sorted[low] + (at - low) * (sorted[high] - sorted[low]);
};
const mean = (list) => (list.length ? list.reduce((a, b) => a + b, 0) / list.length : null);

function sweepLegend() { return { top: 0, type: "scroll", textStyle: { color: color("soft") }, itemWidth: 18, itemHeight: 10 }; }
function levelAxis(view) {
  const axis = view.x < 0 ? null : view.data.axes[view.x];
  const common = { ...axisStyle(), name: axis ? axis.title : "", nameLocation: "middle", nameGap: 30 };
  const value = axis && view.isNumeric(view.x) && axis.values.length > 1;
  if (!value) return { type: "category", data: view.levels(), ...common };
  return { type: view.logX && axis.values.every((v) => v > 0) ? "log" : "value", scale: true, ...common };
}
const placeOf = (view, level) => (levelAxis(view).type === "category" ? level : view.data.axes[view.x].values[level]);

function successOption(view, cells) {
  const many = view.levels().length > 1;
  return {
    grid: { left: 8, right: 16, top: 34, bottom: many ? 28 : 12, containLabel: true }, legend: sweepLegend(),
    tooltip: { trigger: "axis", ...tooltipStyle(), confine: true, valueFormatter: (v) => `${figure(Array.isArray(v) ? v[1] : v, 3)} %` },
    xAxis: levelAxis(view), yAxis: { type: "value", min: 0, max: 100, ...axisStyle(), axisLabel: { color: color("soft"), formatter: "{value} %" } },
    series: view.data.methods.map((name, m) => ({ name, type: many ? "line" : "bar", color: methodColor(m), symbolSize: 7, lineStyle: { width: 2.2 },
      data: cells.map((row, level) => [placeOf(view, level), row[m].tasks ? (100 * row[m].answered) / row[m].tasks : null]) })),
  };
}

// A logarithmic axis that begins and ends near the data.
const logRange = (values) => {
  const known = values.filter((v) => v > 1e-12);
  if (!known.length) return {};
  const largest = Math.max(...known), power = 10 ** Math.floor(Math.log10(largest));
  return { min: roundStep(Math.min(...known)), max: [1, 2, 5, 10].map((step) => step * power).find((end) => end >= 0.999 * largest) };
};

const valueStyle = () => ({ ...axisStyle(), axisLabel: { color: color("soft"), formatter: (v) => String(+v.toPrecision(2)) } });

// The band is a transparent line with the difference stacked on it. It has its method's name, so that the legend switches
// both; the median comes first, since the legend draws the first series of a name.
function errorOption(view, cells) {
  const [, low, high] = BANDS[view.band], series = [];
  view.data.methods.forEach((name, m) => {
    const at = (q) => cells.map((row, level) => [placeOf(view, level), sortedQuantile(row[m].values, q)]).filter(([, v]) => v !== null && (!view.log || v > 0));
    series.push({ name, type: "line", color: methodColor(m), symbolSize: 7, lineStyle: { width: 2.2 }, z: 3, data: at(0.5) });
    if (high > low) {
      const bottom = at(low), top = at(high);
      const plain = { name, type: "line", stack: "band" + m, stackStrategy: "all", symbol: "none", lineStyle: { opacity: 0 }, silent: true, tooltip: { show: false }, color: methodColor(m) };
      series.push({ ...plain, data: bottom }, { ...plain, areaStyle: { opacity: 0.16, color: methodColor(m) }, data: top.map(([x, v], i) => [x, v - bottom[i][1]]) });
    }
  });
  return {
    grid: { left: 8, right: 16, top: 34, bottom: 28, containLabel: true }, legend: { ...sweepLegend(), data: view.data.methods },
    tooltip: { trigger: "axis", ...tooltipStyle(), confine: true, valueFormatter: (v) => `${figure(Array.isArray(v) ? v[1] : v)} ${view.unit()}` },
    xAxis: levelAxis(view), yAxis: { type: view.log ? "log" : "value", ...(view.log ? logRange(cells.flatMap((row) => row.flatMap((cell) => [low, 0.5, high].map((q) => sortedQuantile(cell.values, q))))) : {}), ...valueStyle() }, series,
  };
}

function boxOption(view) {
  const cells = view.gather(() => 0, 1)[0], known = view.data.methods.map((_, m) => m).filter((m) => cells[m].values.length);
  const five = (m) => [0.05, 0.25, 0.5, 0.75, 0.95].map((q) => Math.max(view.log ? 1e-12 : 0, sortedQuantile(cells[m].values, q)));
  return {
    grid: { left: 8, right: 16, top: 14, bottom: 8, containLabel: true }, tooltip: { trigger: "item", ...tooltipStyle(), confine: true },
    xAxis: { type: "category", data: known.map((m) => view.data.methods[m]), ...axisStyle(), axisLabel: { color: color("ink"), interval: 0, rotate: known.length > 5 ? 25 : 0 } },
    yAxis: { type: view.log ? "log" : "value", ...(view.log ? logRange(known.flatMap(five)) : {}), ...valueStyle() },
    series: [{ type: "boxplot", boxWidth: [12, 46], data: known.map((m) => ({ value: five(m), itemStyle: { color: color("card"), borderColor: methodColor(m), borderWidth: 2 } })) }],
  };
}

function heatOption(view, method, other) {
  const axes = view.data.axes, rows = axes[other].levels.length, columns = view.levels().length;
  const cells = view.gather((task) => view.data.tasks[task][other] * columns + view.data.tasks[task][view.x], rows * columns), list = [];
  for (let y = 0; y < rows; ++y) for (let x = 0; x < columns; ++x) {
    const value = sortedQuantile(cells[y * columns + x][method].values, 0.5);
    if (value !== null) list.push([x, y, view.log ? Math.log10(Math.max(value, 1e-12)) : value, value]);
  }
  const shown = list.map((entry) => entry[2]);
  return {
    grid: { left: 8, right: 90, top: 10, bottom: 28, containLabel: true },
    tooltip: { ...tooltipStyle(), confine: true, formatter: ({ value }) => `${axes[view.x].levels[value[0]]}, ${axes[other].levels[value[1]]}: ${figure(value[3])} ${view.unit()}` },
    xAxis: { type: "category", data: view.levels(), name: axes[view.x].title, nameLocation: "middle", nameGap: 30, ...axisStyle() },
    yAxis: { type: "category", data: axes[other].levels, name: axes[other].title, ...axisStyle() },
    visualMap: { dimension: 2, min: Math.min(...shown), max: Math.max(...shown), calculable: true, orient: "vertical", right: 0, top: "middle", textStyle: { color: color("soft") },
      formatter: (v) => figure(view.log ? 10 ** v : v), inRange: { color: ["#0d3b66", "#2a7fb8", "#8fd0c4", "#f7e08a", "#ee964b", "#c1272d"] } },
    series: [{ type: "heatmap", data: list, label: { show: rows * columns <= 80, formatter: ({ value }) => figure(value[3]), color: "#111", textBorderColor: "#fff", textBorderWidth: 2 }, itemStyle: { borderColor: color("card"), borderWidth: 1 } }],
  };
}

function sweepTable(view, cells) {
  const head = [view.x < 0 ? "" : view.data.axes[view.x].title, "method", "answered", "median", "mean", "95 %", "largest"], rows = [];
  cells.forEach((row, level) => view.data.methods.forEach((name, m) => {
    const { values, answered, tasks } = row[m];
    rows.push(Object.assign([m === 0 ? view.levels()[level] : "", { node: h("span", {}, h("span", { class: "dot", style: { background: methodColor(m) } }), name), plain: name }, `${answered} of ${tasks}`,
      ...[sortedQuantile(values, 0.5), mean(values), sortedQuantile(values, 0.95), values.length ? values[values.length - 1] : null].map((v) => figure(v))], { first: m === 0 && level > 0 }));
  }));
  return [head, rows];
}

function sweepHead(data, view) {
  const all = view.gather(() => 0, 1)[0], order = data.methods.map((_, m) => m).sort((a, b) => all[b].answered - all[a].answered || (sortedQuantile(all[a].values, 0.5) ?? Infinity) - (sortedQuantile(all[b].values, 0.5) ?? Infinity));
  const share = (m) => (all[m].answered === 0 ? `${data.methods[m]} gives nothing for ${view.subjects[0][1]}` : `${data.methods[m]} answers ${Math.round((100 * all[m].answered) / Math.max(1, all[m].tasks))} % of the tasks` + (all[m].values.length ? ` with a median position error of ${figure(sortedQuantile(all[m].values, 0.5))} cm` : ""));
  const rigs = data.rows.subject.filter((s) => data.subjects[s].startsWith("rig:")).length, wanted = data.tasks.length * data.methods.length;
  replace(document.getElementById("head"), h("div", { class: "top" }, h("h1", {}, data.title), h("span", { class: "brand" }, `Rigproof ${data.version} \u00b7 sweep`)),
    h("div", { class: "verdict " + (rigs < wanted ? "suspect" : "plain"), role: "status" }, h("div", { class: "word" }, `${plural(data.tasks.length, "task")}, ${plural(data.methods.length, "method")}`),
      h("p", { class: "sentence" }, rigs < wanted ? `${rigs} of ${wanted} answers are there.` : "All answers are there."), h("ul", {}, order.map((m) => h("li", {}, share(m) + ".")))));
}

function sweepControls(view, draw) {
  const { data } = view, set = (key, map = (v) => v) => (value) => { view[key] = map(value); draw(); };
  const filters = view.choices.map((axis) => choice(data.axes[axis].title, ["all", ...data.axes[axis].levels], (v) => { view.fixed[axis] = v === 0 ? null : v - 1; draw(); }));
  return h("div", { class: "card", id: "controls" }, h("div", { class: "bar" },
    choice("show", KINDS, set("kind"), view.kind), choice("of", QUANTITIES, set("q"), view.q),
    view.subjects.length > 1 ? choice("", view.subjects.map(([, name]) => name), set("subject")) : null,
    view.choices.length > 1 ? choice("over", view.choices.map((i) => data.axes[i].title), set("x", (i) => view.choices[i]), view.choices.indexOf(view.x)) : null,
    choice("band", BANDS.map(([name]) => name), set("band")), checkbox("log errors", view.log, set("log")), checkbox("log axis", view.logX, set("logX"))),
  filters.length > 1 ? h("div", { class: "bar", style: { marginTop: "8px" } }, h("span", { class: "soft" }, "only"), filters) : null);
}

function sweepMap(view, draws) {
  if (view.choices.length < 2) return null;
  let method = 0;
  const node = h("div", { class: "chart", style: { height: "380px" } }), other = () => view.choices.find((i) => i !== view.x);
  const draw = chart(node, () => heatOption(view, method, other()));
  draws.push(draw);
  return section("map", "Map of two fields", "The median, over the field chosen above and another.", h("div", { class: "card" }, h("div", { class: "bar" }, choice("method", view.data.methods, (m) => { method = m; draw(); })), node));
}

function failuresSection(data) {
  if (!data.failures.length) return null;
  const head = ["method", "tasks", "status", "why", "code"], rows = data.failures.map((f) => [f.method, String(f.tasks), f.status.replaceAll("_", " "), sentence(f.reason), { node: h("code", {}, f.code), plain: f.code }]);
  return section("failures", "What was not answered, and why", null, h("div", { class: "card" }, h("div", { class: "bar" }, copyButtons(() => [head, rows])), table(head, rows, { text: [0, 2, 3, 4], caption: "Failures" })));
}

function showSweep(data) {
  const view = new SweepView(data), draws = [], success = h("div", { class: "chart" }), error = h("div", { class: "chart", style: { height: "400px" } }), boxes = h("div", { class: "chart", style: { height: "340px" } }), tableCard = h("div", { class: "card" });
  let cells = view.gather();
  const titles = [h("h3", {}), h("h3", {})];
  const drawTable = () => {
    for (const title of titles) title.textContent = view.title();
    const [head, rows] = sweepTable(view, cells);
    replace(tableCard, h("div", { class: "bar" }, h("h3", {}, view.title()), copyButtons(() => [head, rows])), table(head, rows, { text: [0, 1], caption: "Figures" }));
  };
  draws.push(chart(success, () => successOption(view, cells)), chart(error, () => errorOption(view, cells)), chart(boxes, () => boxOption(view)));
  whenShown(drawTable);
  const draw = () => { cells = view.gather(); for (const each of draws) each(); drawTable(); };
  sweepHead(data, view);
  const parts = [
    section("success", "Answered", "Share of the tasks in which a method gives the quantity for every camera (or pair).", sweepControls(view, draw), h("div", { class: "card" }, success)),
    section("errors", "Errors", "Median, and a band of quantiles, over tasks and cameras.", h("div", { class: "card" }, titles[0], error)),
    section("boxes", "Methods side by side", "Quantiles 5, 25, 50, 75 and 95 % over everything that is chosen.", h("div", { class: "card" }, titles[1], boxes)),
    sweepMap(view, draws), section("figures", "Figures", null, tableCard), failuresSection(data),
  ].filter(Boolean);
  document.getElementById("head").append(drawNavigation(parts));
  replace(document.getElementById("main"), ...parts);
  attached = true;
  redrawAll();
}
