// What a sweep's rows say about each level of a field and each method.
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

const sortedQuantile = (sorted, q) => {
  if (!sorted.length) return null;
  const at = q * (sorted.length - 1), low = Math.floor(at), high = Math.min(sorted.length - 1, low + 1);
  return sorted[low] + (at - low) * (sorted[high] - sorted[low]);
};
const ascending = (a, b) => a - b;
const mean = (list) => (list.length ? list.reduce((a, b) => a + b, 0) / list.length : null);

// Of one method at one place. `tasks`: how many have a result; `open`: tasks with whether each camera (or pair) has the quantity; `status`: how each task
// ended; `nees`: of all cameras of a task together, with its degrees of freedom.
const newCell = () => ({ values: [], answered: 0, refused: 0, tasks: 0, open: new Map(), status: new Map(), nees: [] });
function count(cell) {
  cell.values.sort(ascending);
  cell.tasks = cell.status.size;
  for (const [task, status] of cell.status) {
    if (cell.open.get(task)) cell.answered++;
    else if (status === "refused" || status === "partial") cell.refused++;
  }
}

// Columns as the report has them: a list, or {runs: [value, count, ..]}.
const asList = (column) => (Array.isArray(column) ? column : column.runs.flatMap((value, i, runs) => (i % 2 ? [] : new Array(runs[i + 1]).fill(value))));

// Values and counts of each (level of x, method) among the tasks that the filters leave.
class SweepView {
  constructor(data) {
    this.data = data;
    this.subjects = SUBJECTS.filter(([kind]) => data.subjects.some((name) => name.startsWith(kind + ":")));
    const free = data.axes.map((_, i) => i).filter((i) => !data.axes[i].pooled && data.axes[i].levels.length > 1);
    this.choices = free.length ? free : data.axes.map((_, i) => i);
    const numeric = this.choices.find((i) => this.isNumeric(i));
    Object.assign(this, { x: numeric ?? this.choices[0] ?? -1, q: 6, kind: 0, subject: 0, band: 0, log: true, logX: false, fixed: {}, legend: { selected: {} } });
  }
  isShown(method) { return this.legend.selected[this.data.methods[method]] !== false; }
  // Ordered levels are joined by lines; names are not.
  isNumeric(axis) { return this.data.axes[axis].levels.every((label) => label !== "" && isFinite(Number(label))); }
  levels() { return this.x < 0 ? ["all"] : this.data.axes[this.x].levels; }
  isOrdered() { return this.x >= 0 && this.levels().length > 1 && this.isNumeric(this.x); }
  // Why the field has no logarithmic axis, where it is one of numbers.
  whyNotLog() { return this.isOrdered() && Math.min(...this.data.axes[this.x].values) <= 0 ? "a level is " + (this.data.axes[this.x].values.includes(0) ? "0" : "negative") : null; }
  xTitle() { return this.x < 0 ? "" : this.data.axes[this.x].title; }
  taskIsIn(task, free) { return Object.entries(this.fixed).every(([axis, level]) => level === null || free.includes(Number(axis)) || this.data.tasks[task][axis] === level); }
  // `free`: fields whose filters do not count, since they are shown.
  gather(place = (task) => (this.x < 0 ? 0 : this.data.tasks[task][this.x]), places = this.levels().length, free = [this.x]) {
    const { rows, methods, tasks, subjects, statuses } = this.data;
    const [isRig, isWanted] = ["rig", this.subjects[this.subject][0]].map((kind) => subjects.map((name) => name.startsWith(kind + ":")));
    const cells = Array.from({ length: places }, () => methods.map(newCell)), isIn = tasks.map((_, t) => this.taskIsIn(t, free));
    for (let i = 0; i < rows.task.length; ++i) {
      const t = rows.task[i];
      if (!isIn[t]) continue;
      const cell = cells[place(t)][rows.method[i]];
      if (isRig[rows.subject[i]]) {
        cell.status.set(t, statuses[rows.status[i]]);
        if (rows.nees[i] !== null) cell.nees.push([rows.nees[i], rows.nees_dof[i]]);
      }
      if (!isWanted[rows.subject[i]]) continue;
      const value = valueOf(rows, i, this.q, this.kind), error = valueOf(rows, i, this.q, 0);
      if (value !== null) cell.values.push(value);
      cell.open.set(t, (cell.open.get(t) ?? true) && error !== null);
    }
    for (const row of cells) row.forEach(count);
    return cells;
  }
  unit() { return this.kind === 1 ? "" : quantityUnit(this.q); }
  title() { return `${this.kind === 0 ? "|error|" : KINDS[this.kind]} of ${QUANTITIES[this.q]}${this.unit() ? ` [${this.unit()}]` : ""}`; }
}
