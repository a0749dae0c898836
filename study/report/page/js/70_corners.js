// Where in the image corners were seen, what is left of them, and what was to be expected.
function cornerTable(data, result, camera, against) {
  const list = [];
  data.frames.forEach((frame, index) => {
    if (frame.camera !== camera || !frame.corners) return;
    const fit = fitOf(result, index);
    cornersOf(frame).forEach((c, i) => {
      const entry = { u: c.u, v: c.v, sigma2: (c.uu + c.vv) / 2, du: null, dv: null };
      if (against === "truth" && c.truth) Object.assign(entry, { du: c.u - c.truth[0], dv: c.v - c.truth[1] });
      if (against === "fit" && fit && fit[2 * i] !== null) Object.assign(entry, { du: fit[2 * i], dv: fit[2 * i + 1] });
      list.push(entry);
    });
  });
  return list;
}

function drawPlane(canvas, camera, index, corners) {
  const ratio = Math.min(2, devicePixelRatio || 1), width = canvas.clientWidth || 400, height = (width * camera.height) / camera.width;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  const pen = canvas.getContext("2d"), scale = width / camera.width, columns = 12, rows = Math.max(1, Math.round((columns * camera.height) / camera.width));
  pen.scale(ratio, ratio);
  pen.fillStyle = color("faint");
  pen.fillRect(0, 0, width, height);
  const counts = new Array(columns * rows).fill(0);
  for (const c of corners) counts[Math.min(rows - 1, Math.max(0, Math.floor(((c.v + 0.5) * rows) / camera.height))) * columns + Math.min(columns - 1, Math.max(0, Math.floor(((c.u + 0.5) * columns) / camera.width)))]++;
  const most = Math.max(1, ...counts);
  pen.fillStyle = cameraColor(index);
  counts.forEach((count, i) => {
    if (!count) return;
    pen.globalAlpha = 0.08 + 0.3 * Math.sqrt(count / most);
    pen.fillRect(((i % columns) * width) / columns, (Math.floor(i / columns) * height) / rows, width / columns + 0.5, height / rows + 0.5);
  });
  pen.globalAlpha = 1;
  const known = corners.filter((c) => c.du !== null), typical = quantile(known.map((c) => Math.hypot(c.du, c.dv)), 0.95);
  const magnified = typical > 0 ? roundStep(18 / (scale * typical)) : 0;
  pen.strokeStyle = pen.fillStyle = cameraColor(index);
  pen.lineWidth = 1;
  pen.beginPath();
  for (const c of known) {
    const x = scale * (c.u + 0.5), y = scale * (c.v + 0.5), length = Math.hypot(c.du, c.dv), cut = Math.min(1, (4 * typical) / Math.max(1e-12, length)) * scale * magnified;
    pen.moveTo(x, y);
    pen.lineTo(x + cut * c.du, y + cut * c.dv);
  }
  pen.stroke();
  pen.fillStyle = color("ink");
  for (const c of corners) pen.fillRect(scale * (c.u + 0.5) - 0.8, scale * (c.v + 0.5) - 0.8, 1.6, 1.6);
  return { magnified, filled: counts.filter(Boolean).length / counts.length };
}

// How often a difference falls into a bin if all is as stated: a sum of normal distributions, one a corner.
function expectedCounts(bins, step, variances) {
  const rough = new Map();  // variances that differ by less than 5 % count as one
  for (const variance of variances) {
    const key = Math.round(Math.log(variance) / 0.05);
    rough.set(key, (rough.get(key) || 0) + 1);
  }
  return bins.map((middle) => {
    let sum = 0;
    for (const [key, count] of rough) {
      const variance = Math.exp(key * 0.05);
      sum += (2 * count * step * Math.exp((-0.5 * middle * middle) / variance)) / Math.sqrt(2 * Math.PI * variance);
    }
    return sum;
  });
}

function histogramOption(corners, index, shrink, others2) {
  const known = corners.filter((c) => c.du !== null), values = known.flatMap((c) => [c.du, c.dv]);
  const detector = known.map((c) => Math.max(1e-12, shrink * shrink * c.sigma2)), withLens = detector.map((v) => v + others2);
  const range = 1.25 * Math.max(quantile(values.map(Math.abs), 0.985), 2.2 * Math.sqrt(quantile(detector, 0.5)), 1e-6), count = 41, step = (2 * range) / count;
  const bins = Array.from({ length: count }, (_, i) => -range + (i + 0.5) * step), counts = new Array(count).fill(0);
  for (const value of values) { const i = Math.floor((value + range) / step); if (i >= 0 && i < count) counts[i]++; }
  const line = (name, data, type) => ({ name, type: "line", data, showSymbol: false, smooth: true, lineStyle: { width: 1.8, type, color: color("ink") }, itemStyle: { color: color("ink") } });
  const most = 1.25 * Math.max(...counts, 1);
  const clipped = (list) => list.map((v) => (v > 3 * most ? 3 * most : v));
  const series = [{ name: "found", type: "bar", data: counts, barCategoryGap: "8%", color: cameraColor(index), itemStyle: { opacity: 0.75 } }, line("by the detector", clipped(expectedCounts(bins, step, detector)), "solid")];
  if (others2 > 0) series.push(line("with the lens residual", clipped(expectedCounts(bins, step, withLens)), "dashed"));
  return {
    grid: { left: 6, right: 10, top: 30, bottom: 4, containLabel: true }, tooltip: { trigger: "axis", ...tooltipStyle(), confine: true, valueFormatter: (v) => figure(v) },
    legend: { top: 0, left: 0, textStyle: { color: color("soft"), fontSize: 11.5 }, itemWidth: 18, itemHeight: 10 },
    xAxis: { type: "category", data: bins.map((b) => figure(b)), ...axisStyle(), axisLabel: { color: color("soft"), interval: 9, formatter: (v, i) => (i === 20 ? "0" : v) + (i === 40 ? " px" : "") } },
    yAxis: { type: "value", max: most, ...axisStyle(), axisLabel: { show: false } }, series,
  };
}

function cornersSection(data, result) {
  if (!data.frames.some((frame) => frame.corners)) return null;
  const hasTruth = data.frames.some((frame) => frame.true);
  let against = "fit";
  const columns = h("div", { class: "columns" }), draws = [];
  const fit = result.corner_fit, shrink = fit.corners ? Math.sqrt(Math.max(0, 1 - (6 * fit.boards) / (2 * fit.corners))) : 1;
  data.cameras.forEach((camera, index) => {
    const canvas = h("canvas", { class: "plane", role: "img", "aria-label": `Corners in the image of ${camera.name}`, style: { aspectRatio: `${camera.width} / ${camera.height}` } });
    const facts = h("p", { class: "small" }), plane = h("p", { class: "small soft" }), node = h("div", { class: "chart", role: "img", "aria-label": `Histogram of the differences of ${camera.name}` });
    const listOf = () => cornerTable(data, result, index, against);
    const tell = () => {
      const list = listOf(), known = list.filter((c) => c.du !== null), drawn = drawPlane(canvas, camera, index, list);
      const found = rms(known.flatMap((c) => [c.du, c.dv])), stated = Math.sqrt(known.reduce((sum, c) => sum + c.sigma2, 0) / Math.max(1, known.length)) * (against === "fit" ? shrink : 1);
      facts.textContent = known.length ? `rms ${figure(found)} px; the detector's sigma alone would leave ${figure(stated)} px` : "no differences";
      plane.textContent = `${plural(list.length, "corner")} in ${Math.round(100 * drawn.filled)} % of the cells` + (drawn.magnified ? `; differences drawn ${drawn.magnified} times too long` : "");
    };
    columns.append(h("div", { class: "card" }, h("h3", {}, withSwatch(index, camera.name)), canvas, plane, node, facts));
    draws.push(tell);
    // What the lens may do beyond its model comes on top of the detector's noise.
    const others2 = () => (against === "fit" ? (camera.lens_residual_px || 0) ** 2 : 0);
    draws.push(chart(node, () => histogramOption(listOf(), index, against === "fit" ? shrink : 1, others2()), 190));
    new ResizeObserver(() => drawPlane(canvas, camera, index, listOf())).observe(canvas);
    whenShown(tell);
  });
  const choose = hasTruth ? h("div", { class: "bar", style: { marginBottom: "12px" } }, choice("detected corners minus", ["the board that fits a stop's views best", "the true corners"], (i) => {
    against = i === 0 ? "fit" : "truth";
    for (const draw of draws) draw();
  })) : null;
  const groups = result.residuals.length ? h("div", { class: "card", style: { marginTop: "14px" } }, h("h3", {}, "Residuals as the method tells them"),
    table(["group", "rms", "unit", "count"], result.residuals.map((r) => [r.name, figure(r.rms, 3), r.unit, String(r.count)]), { text: [0, 2] })) : null;
  return section("corners", "Corners: coverage and residuals", "Darker cells hold more corners; empty ones tell nothing. Below, the differences along u and v against the normal distribution that the stated noise predicts.",
    choose, columns, groups);
}
