// Charts of a sweep: answers and errors over a field, methods side by side.
const sweepLegend = (view, names) => ({ top: 0, left: view.isOrdered() ? "center" : 0, type: "scroll", data: names, textStyle: { color: color("soft") }, itemWidth: 18, itemHeight: 10 });

// Names may be long: so many that they would hide each other are written aslant. The field's name is in the title.
function nameAxis(names) {
  const isAslant = Math.max(...names.map((name) => name.length)) * names.length > Math.min(1240, innerWidth) / 11;
  const label = { color: color("ink"), interval: 0, ...(isAslant ? { rotate: 35, width: 190, overflow: "truncate" } : {}) };
  return { type: "category", data: names, ...axisStyle(), axisLabel: label };
}
function levelAxis(view) {
  if (!view.isOrdered()) return nameAxis(view.levels());
  const { title, values } = view.data.axes[view.x], common = { ...axisStyle(), name: title, nameLocation: "middle", nameGap: 30, nameTruncate: { maxWidth: Math.min(1100, innerWidth - 90), ellipsis: "\u2026" } };
  const number = (v) => String(+v.toPrecision(3)), label = { ...common.axisLabel, formatter: number };
  return { type: view.logX && !view.whyNotLog() ? "log" : "value", ...common, min: Math.min(...values), max: Math.max(...values), axisLabel: label };
}
// By the field, in whatever order its levels stand.
const inOrder = (view, points) => (view.isOrdered() ? [...points].sort((a, b) => (a.value ?? a)[0] - (b.value ?? b)[0]) : points);
const placeOf = (view, level) => (view.isOrdered() ? view.data.axes[view.x].values[level] : level);
const sweepGrid = (view) => ({ left: 8, right: 18, top: 34, bottom: view.isOrdered() ? 28 : 8, containLabel: true });
// Charts of names are as wide as they must be, and scroll on a narrow screen.
const widthFor = (view) => (view.isOrdered() ? "" : `${view.levels().length * Math.max(44, 14 * view.data.methods.length)}px`);

// A logarithmic axis that begins and ends near the data.
const LOG_STEPS = [1, 1.5, 2, 3, 5, 7, 10];
const logRange = (values) => {
  const known = values.filter((v) => v > 1e-12);
  if (!known.length) return {};
  const power = (v) => 10 ** Math.floor(Math.log10(v)), ends = (v) => LOG_STEPS.map((step) => step * power(v));
  const least = Math.min(...known), largest = Math.max(...known);
  return { min: ends(least).findLast((end) => end <= 1.001 * least), max: ends(largest).find((end) => end >= 0.999 * largest) };
};
const valueAxis = (isLog, values) => ({ type: isLog ? "log" : "value", ...(isLog ? logRange(values) : {}), ...axisStyle(),
  axisLabel: { color: color("soft"), formatter: (v) => String(+v.toPrecision(2)) } });
const atPoint = (unit, digits) => ({ trigger: "axis", ...tooltipStyle(), confine: true, valueFormatter: (v) => `${figure(Array.isArray(v) ? v[1] : v, digits)} ${unit}` });

function successOption(view, cells) {
  return {
    grid: sweepGrid(view), legend: sweepLegend(view, view.data.methods), tooltip: atPoint("%", 3),
    xAxis: levelAxis(view), yAxis: { type: "value", min: 0, max: 100, ...axisStyle(), axisLabel: { color: color("soft"), formatter: "{value} %" } },
    series: view.data.methods.map((name, m) => ({ name, type: view.isOrdered() ? "line" : "bar", color: methodColor(m), symbolSize: 7, lineStyle: { width: 2.2 }, barMaxWidth: 40,
      data: inOrder(view, cells.map((row, level) => [placeOf(view, level), row[m].tasks ? (100 * row[m].answered) / row[m].tasks : null])) })),
  };
}

// A band is a transparent line with the difference stacked on it. It has its method's name, so that the legend switches
// both; what is drawn as a line comes first, since the legend draws the first series of a name.
function bandSeries(name, value, bottom, top, opacity = 0.16) {
  const plain = { name, type: "line", stack: "band " + name, stackStrategy: "all", symbol: "none", lineStyle: { opacity: 0 }, silent: true, tooltip: { show: false }, color: value };
  return [{ ...plain, data: bottom }, { ...plain, areaStyle: { opacity, color: value }, data: top.map(([x, v], i) => [x, v - bottom[i][1]]) }];
}
function lineSeries(view, cells, m) {
  const [, low, high] = BANDS[view.band], name = view.data.methods[m], value = methodColor(m);
  // Where there is a value, in the order of the field; a band's two sides at the same places.
  const at = (...list) => cells.map((row, level) => [placeOf(view, level), ...list.map((q) => sortedQuantile(row[m].values, q))])
    .filter(([, v]) => v !== null && (!view.log || v > 0)).sort(([a], [b]) => a - b);
  const median = { name, type: "line", color: value, symbolSize: 7, lineStyle: { width: 2.2 }, z: 3, data: at(0.5) };
  const band = at(low, high);
  return high > low ? [median, ...bandSeries(name, value, band.map(([x, v]) => [x, v]), band.map(([x, , v]) => [x, v]))] : [median];
}
const BOX = [0.05, 0.25, 0.5, 0.75, 0.95];
const fiveOf = (view, cell) => BOX.map((q) => Math.max(view.log ? 1e-12 : 0, sortedQuantile(cell.values, q)));
function boxSeries(view, cells, m) {
  const style = { color: color("card"), borderColor: methodColor(m), borderWidth: 2 };
  return { name: view.data.methods[m], type: "boxplot", boxWidth: [5, 30], color: methodColor(m), itemStyle: style, data: cells.map((row) => (row[m].values.length ? fiveOf(view, row[m]) : [])) };
}

function errorOption(view, cells) {
  const isOrdered = view.isOrdered(), known = isOrdered ? BANDS[view.band].slice(1).concat(0.5) : BOX;
  const values = cells.flatMap((row) => row.flatMap((cell) => known.map((q) => sortedQuantile(cell.values, q))));
  return {
    grid: sweepGrid(view), legend: { ...sweepLegend(view, view.data.methods), ...(isOrdered ? {} : { icon: "circle" }) },
    tooltip: isOrdered ? atPoint(view.unit()) : { trigger: "item", ...tooltipStyle(), confine: true },
    xAxis: levelAxis(view), yAxis: valueAxis(view.log, values),
    series: view.data.methods.flatMap((_, m) => (isOrdered ? lineSeries(view, cells, m) : boxSeries(view, cells, m))),
  };
}

function boxOption(view) {
  const cells = view.gather(() => 0, 1)[0], known = view.data.methods.map((_, m) => m).filter((m) => cells[m].values.length && view.isShown(m));
  return {
    grid: { left: 8, right: 16, top: 14, bottom: 8, containLabel: true }, tooltip: { trigger: "item", ...tooltipStyle(), confine: true },
    xAxis: nameAxis(known.map((m) => view.data.methods[m])), yAxis: valueAxis(view.log, known.flatMap((m) => fiveOf(view, cells[m]))),
    series: [{ type: "boxplot", boxWidth: [12, 46], data: known.map((m) => ({ value: fiveOf(view, cells[m]), itemStyle: { color: color("card"), borderColor: methodColor(m), borderWidth: 2 } })) }],
  };
}
