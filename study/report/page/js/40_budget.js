// What each stated variance is made of.
const SOURCE_COLORS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8a6a3f", "#7070d8", "#b0b7bf", "#4d9a9a"];

function budgetSection(data, result) {
  const known = [...result.poses.map((t) => [t, t.child]), ...result.pairs.map((t) => [t, `${t.parent}\u2013${t.child}`])]
    .filter(([t]) => t.budget.length && t.sigma);
  if (!known.length) return null;
  const total = new Map();
  for (const [t] of known) for (const { source, share } of t.budget) total.set(source, (total.get(source) || 0) + share.reduce((a, b) => a + b, 0));
  const sources = [...total.keys()].sort((a, b) => total.get(b) - total.get(a));
  const size = ([t]) => Math.max(...t.sigma.slice(0, 3).map((v) => v ?? 0));
  let shown = known.slice(0, result.poses.length || 1).reduce((best, entry) => (size(entry) > size(best) ? entry : best), known[0]);
  const words = h("p", { class: "small soft" });
  const node = h("div", { class: "chart", role: "img", "aria-label": "Share of each source in the variance of each degree of freedom" });
  const axes = () => AXES.map((_, i) => i).filter((i) => shown[0].observable[i]);
  const narrow = () => node.clientWidth < 520;
  const option = () => ({
    grid: { left: 8, right: 8, top: 8, bottom: narrow() ? 86 : 56, containLabel: true },
    legend: { bottom: 0, textStyle: { color: color("soft") }, itemWidth: 12, itemHeight: 12, icon: "rect", type: narrow() ? "scroll" : "plain" },
    tooltip: { trigger: "axis", axisPointer: { type: "shadow" }, ...tooltipStyle(), confine: true, order: "valueDesc", valueFormatter: (v) => `${figure(v)} %` },
    xAxis: { type: "value", max: 100, ...axisStyle(), axisLabel: { color: color("soft"), formatter: "{value} %" } },
    yAxis: { type: "category", inverse: true, data: axes().map((i) => `${AXES[i]}   ${figure(inUnit(shown[0].sigma[i], i))} ${unitOf(i)}`), ...axisStyle(),
      axisLabel: { color: color("ink"), fontSize: 13 } },
    series: sources.map((source, k) => {
      const entry = shown[0].budget.find((b) => b.source === source);
      return { name: source, type: "bar", stack: "all", barWidth: "62%", color: SOURCE_COLORS[k % SOURCE_COLORS.length],
        label: { show: true, color: inkOn(SOURCE_COLORS[k % SOURCE_COLORS.length]), fontSize: 11, formatter: ({ value }) => (value >= 9 ? `${Math.round(value)}` : "") },
        data: axes().map((i) => (entry ? 100 * entry.share[i] : 0)) };
    }).filter((series) => series.data.some((v) => v > 0.05)),
  });
  const card = h("div", { class: "card" });
  const tell = () => {
    const groups = new Map();
    for (const i of axes()) {
      const most = shown[0].budget.reduce((best, b) => (b.share[i] > best.share[i] ? b : best)), group = groups.get(most.source) || { names: [], shares: [] };
      group.names.push(AXES[i]);
      group.shares.push(Math.round(100 * most.share[i]));
      groups.set(most.source, group);
    }
    words.textContent = "Mostly from: " + [...groups].map(([source, { names, shares }]) => {
      const least = Math.min(...shares), largest = Math.max(...shares);
      return `${source} in ${names.join(", ")} (${least < largest ? `${least} to ` : ""}${largest} %)`;
    }).join("; ") + ".";
  };
  const names = known.map(([, name]) => name);
  card.append(h("div", { class: "bar" }, choice("of", names, (i) => { shown = known[i]; tell(); draw(); }, known.indexOf(shown))), node, words);
  const draw = chart(node, option, 320);
  tell();
  if (result.sources.length)
    card.append(h("p", { class: "small" }, "The least certain camera, and what would help:"), h("ul", { class: "small" }, result.sources.map((sentence) => h("li", {}, prose(sentence)))));
  return section("budget", "Uncertainty budget",
    "Where the stated uncertainty comes from: shares of the variance of each degree of freedom. What is largest is what to measure or record better.", card);
}
