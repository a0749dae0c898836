// Where answers degenerate: a table of two fields, coloured, of one method.
const MAP_COLORS = [[13, 59, 102], [42, 127, 184], [143, 208, 196], [247, 224, 138], [238, 150, 75], [193, 39, 45]];
function mapColor(share) {
  const at = Math.min(0.99999, Math.max(0, share)) * (MAP_COLORS.length - 1), low = Math.floor(at);
  return MAP_COLORS[low].map((v, i) => Math.round(v + (at - low) * (MAP_COLORS[low + 1][i] - v)));
}
const isLight = ([red, green, blue]) => 0.3 * red + 0.59 * green + 0.11 * blue > 130;
const css = (rgb) => `rgb(${rgb.join(" ")})`;
const share = (count, of) => (of ? (100 * count) / of : null);
const middleOf = (list) => sortedQuantile([...list].sort(ascending), 0.5);

// What the map may show: value of a cell, as written, and where a colour stands between the least and the largest, 0 to 1.
const linear = (least, largest) => (v) => (largest > least ? (v - least) / (largest - least) : 0.5);
const percent = { unit: "%", isShare: true, ends: () => [0, 100] };
const MAP_QUANTITIES = [
  { name: "what is chosen above (median)", title: (view) => "Median " + view.title(), value: (cell) => sortedQuantile(cell.values, 0.5), unit: "",
    ends: (values) => [Math.min(...values), Math.max(...values)], isLog: (view) => view.log },
  { ...percent, name: "share answered", title: () => "Share of the tasks answered [%]", value: (cell) => (cell.status.size ? share(cell.answered, cell.tasks) : null), isDown: true },
  { ...percent, name: "share refused", title: () => "Share of the tasks refused, whole or in part [%]", value: (cell) => (cell.status.size ? share(cell.refused, cell.tasks) : null) },
  { name: "NEES (median)", title: () => "Median NEES for each degree of freedom (about 1 if sigmas are honest)", value: (cell) => middleOf(cell.nees.map(([v, dof]) => v / dof)), unit: "",
    ends: (values) => { const most = Math.max(1.5, ...values.map((v) => Math.max(v, 1 / Math.max(v, 1e-12)))); return [1 / most, most]; }, isLog: () => true },
];
function placeOnScale(quantity, view, values) {
  const ends = quantity.ends(values), map = quantity.isLog && quantity.isLog(view) ? (v) => Math.log(Math.max(v, 1e-12)) : (v) => v;
  const along = linear(...ends.map(map));
  return { ends, place: (v) => (quantity.isDown ? 1 - along(map(v)) : along(map(v))) };
}

// Why a cell has no figure, in a word.
function whyEmpty(cell) {
  if (!cell.status.size) return "not run";
  if (cell.answered) return "not stated";
  if (cell.refused) return "refused";
  const counts = new Map();
  for (const status of cell.status.values()) counts.set(status, (counts.get(status) || 0) + 1);
  const [most] = [...counts].reduce((best, entry) => (entry[1] > best[1] ? entry : best));
  return most === "solved" ? "not given" : most.replaceAll("_", " ");
}
function mapCell(cell, value, place, where, withStrip) {
  const told = `${where}: ${value === null ? whyEmpty(cell) : figure(value, 3)}; ${cell.answered} of ${cell.tasks} answered, ${cell.refused} refused`;
  if (value === null) return h("td", { class: cell.status.size ? "hatched" : "open", title: told }, h("span", {}, whyEmpty(cell)));
  const rgb = mapColor(place(value)), open = cell.tasks ? 1 - cell.answered / cell.tasks : 0;
  return h("td", { title: told, style: { background: css(rgb), color: isLight(rgb) ? "#111" : "#fff" } }, figure(value),
    withStrip && open > 0 ? h("i", { class: "hatched", style: { width: `${100 * open}%` } }) : null);
}

function mapTable(view, method, other, quantity) {
  const { axes, tasks } = view.data, columns = view.levels(), rows = axes[other].levels;
  const cells = view.gather((task) => tasks[task][other] * columns.length + tasks[task][view.x], rows.length * columns.length, [view.x, other]).map((row) => row[method]);
  const values = cells.map(quantity.value), known = values.filter((v) => v !== null), scale = placeOnScale(quantity, view, known.length ? known : [1]);
  const at = (y, x) => y * columns.length + x;
  const node = h("table", { class: "map", style: { maxWidth: `${240 + 110 * columns.length}px` } },
    h("thead", {}, h("tr", {}, h("th", { rowspan: 2, scope: "col", class: "down" }, axes[other].title), h("th", { colspan: columns.length, scope: "colgroup" }, view.xTitle())),
      h("tr", {}, columns.map((level) => h("th", { scope: "col" }, level)))),
    h("tbody", {}, rows.map((level, y) => h("tr", {}, h("th", { scope: "row" }, level),
      columns.map((name, x) => mapCell(cells[at(y, x)], values[at(y, x)], scale.place, `${view.xTitle()} ${name}, ${axes[other].title} ${level}`, !quantity.isShare))))));
  const copied = [[axes[other].title, view.xTitle(), quantity.title(view), "answered", "refused", "tasks"],
    rows.flatMap((level, y) => columns.map((name, x) => { const { answered, refused, tasks: all } = cells[at(y, x)]; return [level, name, { text: figure(values[at(y, x)]), raw: values[at(y, x)] ?? "" }, String(answered), String(refused), String(all)]; }))];
  return { node, copied, ends: known.length ? scale.ends : null };
}

function mapKey(ends, quantity) {
  const strip = MAP_COLORS.map((_, i) => css(mapColor((quantity.isDown ? MAP_COLORS.length - 1 - i : i) / (MAP_COLORS.length - 1)))).join(", ");
  return h("div", { class: "legend" },
    ends ? h("span", { class: "nowrap" }, figure(ends[0]), h("span", { class: "strip", style: { background: `linear-gradient(to right, ${strip})` } }), `${figure(ends[1], 3)} ${quantity.unit}`) : null,
    quantity.isShare ? null : h("span", {}, h("span", { class: "strip hatched short" }), "not answered; below a figure: the share of its tasks that is not"));
}

function sweepMap(view, draws) {
  const { axes, methods } = view.data, varied = axes.map((_, i) => i).filter((i) => axes[i].levels.length > 1);
  if (varied.length < 2 || view.x < 0) return null;
  const place = h("div", {}), title = h("h3", {}), fields = h("span", {}), shown = { method: 0, quantity: 0, other: varied.find((i) => i !== view.x) };
  let copied;
  const draw = () => {
    const quantity = MAP_QUANTITIES[shown.quantity], map = mapTable(view, shown.method, shown.other, quantity);
    copied = map.copied;
    title.textContent = `${quantity.title(view)}, ${methods[shown.method]}`;
    replace(place, scrolling(title.textContent, map.node), mapKey(map.ends, quantity));
  };
  const set = (key) => (value) => { shown[key] = value; draw(); };
  // Fields to choose among are all but the one above.
  let last = null;
  const drawAll = () => {
    if (last !== view.x) {
      last = view.x;
      const others = varied.filter((i) => i !== view.x);
      if (!others.includes(shown.other)) shown.other = others[0];
      replace(fields, choice("down", others.map((i) => axes[i].title), (i) => set("other")(others[i]), others.indexOf(shown.other)));
    }
    draw();
  };
  draws.push(drawAll);
  whenShown(drawAll);
  return section("map", "Map of two fields", "Where answers are refused, fail or go wrong: across, the field chosen above; down, another; all of their levels.", h("div", { class: "card" },
    h("div", { class: "bar" }, choice("show", MAP_QUANTITIES.map(({ name }) => name), set("quantity")), fields, choice("method", methods, set("method")), copyButtons(() => copied)),
    title, place));
}
