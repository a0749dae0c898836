// Tables that may be copied as CSV, Markdown and LaTeX. A cell is text, a node, or {text or node, plain, raw}: `plain` is what
// is copied, `raw` what CSV has of it, since that is to be computed with: numbers with all digits, names in every row.
// A head with a list as `raw` stands for so many columns.
const plain = (cell) => (cell === null || cell === undefined ? "" : typeof cell === "object" ? cell.plain ?? cell.text : String(cell));

// A sentence, with code as code; copied as it is.
const textCell = (text) => ({ node: h("span", {}, prose(text)), plain: sentence(text) });

// Digits beyond the twelfth come from the change of units.
const rawText = (value) => (typeof value === "number" ? (isFinite(value) ? String(Number(value.toPrecision(12))) : "") : value ?? "");
const rawOf = (cell) => (cell && typeof cell === "object" && cell.raw !== undefined ? cell.raw : plain(cell).replaceAll("\u2212", "-").replace(/^[\u2013]$/, ""));

function asCsv(head, rows) {
  const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const line = (row) => row.flatMap((cell, i) => {
    const columns = [head[i].raw ?? ""].flat().length, list = [rawOf(cell)].flat().map((value) => quoted(rawText(value)));
    return [...list, ...Array(columns - list.length).fill("")];
  }).join(",");
  return [head, ...rows].map(line).join("\n") + "\n";
}
// Value and sigma have columns of their own.
const withSigmaHead = (name) => ({ text: name, raw: [name, "sigma of " + name] });
// A name that is written once for several rows.
const named = (cell, isFirst) => (isFirst ? cell : { text: "", plain: "", raw: plain(cell) });

const asMarkdown = (head, rows) => [head, head.map((_, i) => (i ? "---:" : "---")), ...rows]
  .map((row) => "| " + row.map((cell) => plain(cell).replaceAll("|", "\\|")).join(" | ") + " |").join("\n") + "\n";

function asLatex(head, rows) {
  const words = { "\\": "\\textbackslash{}", "~": "\\textasciitilde{}", "^": "\\textasciicircum{}" };
  const escaped = (cell) => plain(cell).replace(/[\\~^&%$#_{}]/g, (sign) => words[sign] ?? "\\" + sign)
    .replaceAll("\u2212", "$-$").replaceAll("\u00b1", "$\\pm$").replaceAll("\u2013", "--");
  const lines = [head, ...rows].map((row) => row.map(escaped).join(" & ") + " \\\\");
  return `\\begin{tabular}{l${"r".repeat(head.length - 1)}}\n\\toprule\n${lines[0]}\n\\midrule\n${lines.slice(1).join("\n")}\n\\bottomrule\n\\end{tabular}\n`;
}

async function copyText(text, button) {
  const label = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = h("textarea", { style: { position: "fixed", opacity: "0" } }, text);
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  button.textContent = "copied";
  setTimeout(() => { button.textContent = label; }, 1200);
}

function copyButtons(contentOf) {
  const kinds = [["CSV", asCsv], ["Markdown", asMarkdown], ["LaTeX", asLatex]];
  return h("span", { class: "copy push soft small" }, "copy as", kinds.map(([name, write]) =>
    h("button", { type: "button", onclick: (event) => copyText(write(...contentOf()), event.currentTarget) }, name)));
}

// Says so where a table is wider than its place.
const overflow = new ResizeObserver((entries) => {
  for (const { target } of entries) {
    const node = target.closest(".scroll");
    node?.classList.toggle("wide", node.scrollWidth > node.clientWidth + 1);
  }
});
function scrolling(label, content) {
  const node = h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, content);
  for (const part of [node, content]) overflow.observe(part);
  return node;
}

function table(head, rows, { text = [0], caption = "" } = {}) {
  const isText = (i) => (text.includes(i) ? "text" : null);
  return scrolling(caption || "table", h("table", {},
    h("thead", {}, h("tr", {}, head.map((cell, i) => h("th", { scope: "col", class: isText(i) }, cell.text ?? cell)))),
    h("tbody", {}, rows.map((row) => h("tr", { class: row.first ? "first" : null }, row.map((cell, i) => {
      const content = cell && typeof cell === "object" && !(cell instanceof Node) ? cell.node ?? cell.text : cell;
      return i === 0 ? h("th", { scope: "row" }, typeof content === "string" ? breakable(content) : content) : h("td", { class: [isText(i), cell && cell.over ? "over" : null].filter(Boolean).join(" ") || null }, content);
    }))))));
}
