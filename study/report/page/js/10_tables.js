// Tables that may be copied as CSV, Markdown and LaTeX. A cell is text, or {text, value} where what is copied differs.
const plain = (cell) => (cell === null || cell === undefined ? "" : typeof cell === "object" ? cell.plain ?? cell.text : String(cell));

const asCsv = (head, rows) => [head, ...rows].map((row) => row.map((cell) => {
  const text = plain(cell).replaceAll("\u2212", "-");
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}).join(",")).join("\n") + "\n";

const asMarkdown = (head, rows) => [head, head.map((_, i) => (i ? "---:" : "---")), ...rows]
  .map((row) => "| " + row.map((cell) => plain(cell).replaceAll("|", "\\|")).join(" | ") + " |").join("\n") + "\n";

function asLatex(head, rows) {
  const escaped = (cell) => plain(cell).replaceAll("\\", "\\textbackslash ").replace(/[&%$#_{}]/g, "\\$&")
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

function table(head, rows, { text = [0], caption = "" } = {}) {
  const isText = (i) => (text.includes(i) ? "text" : null);
  return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption || "table" }, h("table", {},
    h("thead", {}, h("tr", {}, head.map((cell, i) => h("th", { scope: "col", class: isText(i) }, cell)))),
    h("tbody", {}, rows.map((row) => h("tr", { class: row.first ? "first" : null }, row.map((cell, i) => {
      const content = cell && typeof cell === "object" && !(cell instanceof Node) ? cell.node ?? cell.text : cell;
      return i === 0 ? h("th", { scope: "row" }, content) : h("td", { class: [isText(i), cell && cell.over ? "over" : null].filter(Boolean).join(" ") || null }, content);
    }))))));
}
