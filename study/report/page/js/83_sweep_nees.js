// Whether stated sigmas are honest: NEES over what was varied, with what chi-square expects of it.

// By Wilson and Hilferty: within 3 % of the 2.5 % quantile for 6 degrees of freedom, and closer for more.
const chiSquareQuantile = (z, k) => k * Math.max(0, 1 - 2 / (9 * k) + z * Math.sqrt(2 / (9 * k))) ** 3;
const WITHIN_95 = 1.959964;

// Mean of NEES over the tasks, for each degree of freedom, and where 95 % of such means lie; null without any.
function neesOf(cell) {
  const sum = cell.nees.reduce((total, [value]) => total + value, 0), freedom = cell.nees.reduce((total, [, dof]) => total + dof, 0);
  if (!(freedom > 0)) return null;
  const [low, high] = [-WITHIN_95, WITHIN_95].map((z) => chiSquareQuantile(z, freedom) / freedom), value = sum / freedom;
  return { value, low, high, tasks: cell.nees.length, isOutside: value < low || value > high };
}

// The band is that of the method with the most tasks; whether a point lies outside is judged by its own, and shows as a ring.
function neesOption(view, cells) {
  const known = view.data.methods.map((_, m) => m).filter((m) => cells.some((row) => row[m].nees.length));
  const points = cells.map((row) => known.map((m) => neesOf(row[m]))), isOrdered = view.isOrdered();
  const bands = points.map((row) => row.filter(Boolean).reduce((best, p) => (!best || p.tasks > best.tasks ? p : best), null));
  const expected = "95 % if honest", soft = color("soft"), ends = (end) => inOrder(view, bands.map((b, level) => [placeOf(view, level), b && b[end]]).filter(([, v]) => v !== null));
  const box = { name: expected, type: "boxplot", boxWidth: [20, 90], color: soft, itemStyle: { color: color("faint"), borderColor: soft }, z: 1, silent: true,
    data: bands.map((b) => (b ? [b.low, b.low, 1, b.high, b.high] : [])) };
  const key = { name: expected, type: "line", symbol: "none", tooltip: { show: false }, color: soft, lineStyle: { type: "dashed", width: 1 }, z: 1, data: ends("low").map(([x]) => [x, 1]) };
  const series = known.map((m, k) => ({ name: view.data.methods[m], type: isOrdered ? "line" : "scatter", color: methodColor(m), lineStyle: { width: 2.2 }, symbol: "circle",
    symbolOffset: isOrdered ? 0 : [12 * (k - (known.length - 1) / 2), 0], z: 3,
    data: inOrder(view, points.flatMap((row, level) => (row[k] ? [{ value: [placeOf(view, level), row[k].value], symbolSize: row[k].isOutside ? 12 : 6,
      itemStyle: row[k].isOutside ? { color: color("card"), borderColor: methodColor(m), borderWidth: 3 } : {} }] : []))) }));
  return {
    grid: sweepGrid(view), legend: sweepLegend(view, [...known.map((m) => view.data.methods[m]), expected]), tooltip: isOrdered ? atPoint("", 3) : { trigger: "item", ...tooltipStyle(), confine: true },
    xAxis: levelAxis(view), yAxis: valueAxis(true, points.flat().concat(bands).filter(Boolean).flatMap((p) => [p.value, p.low, p.high])),
    series: [...series, ...(isOrdered ? [key, ...bandSeries(expected, soft, ends("low"), ends("high"), 0.22)] : [box])],
  };
}

// In words: where sigmas are too small or too large, and by how much at most.
function outsideWords(view, outside) {
  if (!outside.length) return null;
  const isSmall = outside[0].value > 1, far = outside.map((p) => Math.abs(1 - 1 / Math.sqrt(p.value)));
  const at = outside.slice(0, 4).map((p) => `${view.levels()[p.level]} (${figure(p.value, 3)}, expected ${figure(p.low, 3)} to ${figure(p.high, 3)})`);
  return `sigmas too ${isSmall ? "small" : "large"} by up to ${Math.round(100 * Math.max(...far))} % at ${at.join(", ")}${outside.length > 4 ? ` and ${outside.length - 4} more` : ""}`;
}
function neesWords(view, cells) {
  const silent = view.data.methods.filter((_, m) => !cells.some((row) => row[m].nees.length));
  const lines = view.data.methods.map((name, m) => {
    const points = cells.map((row, level) => ({ level, ...neesOf(row[m]) })).filter((p) => p.tasks), outside = points.filter((p) => p.isOutside);
    if (!points.length) return null;
    if (!outside.length) return `${name}: as expected at ${points.length > 1 ? `all ${points.length} levels` : "the one level"}.`;
    const words = [outside.filter((p) => p.value > 1), outside.filter((p) => p.value < 1)].map((list) => outsideWords(view, list)).filter(Boolean);
    return `${name}: outside at ${outside.length} of ${plural(points.length, "level")}: ${words.join("; ")}.`;
  }).filter(Boolean);
  return silent.length ? [...lines, `Without NEES: ${silent.join(", ")}.`] : lines;
}
