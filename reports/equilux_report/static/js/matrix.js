// Search, filters, order and keys of the overview's matrix. Its whole state is in the fragment.
const NAMES = ["q", "verdict", "finding", "cause", "status", "adapter", "family", "feature", "sort", "pairs", "view"];

eq.define("eq-matrix", class extends HTMLElement {
  connectedCallback() {
    this.form = this.querySelector("form");
    this.table = this.querySelector("table");
    this.groups ??= [...this.table.tBodies];
    this.rows ??= [...this.table.querySelectorAll("tr.row")];
    this.rows.forEach((row, index) => { row.dataset.index = index; });
    this.stop = new AbortController();
    const { signal } = this.stop;
    this.form.addEventListener("input", () => this.apply(), { signal });
    this.form.addEventListener("submit", (event) => event.preventDefault(), { signal });
    this.form.addEventListener("reset", () => queueMicrotask(() => this.reset()), { signal });
    this.querySelector("[data-reset]").addEventListener("click", () => this.reset(), { signal });
    document.addEventListener("click", (event) => this.follow(event), { signal });
    document.addEventListener("keydown", (event) => this.key(event), { signal });
    window.addEventListener("hashchange", () => this.read(eq.fragment.read()), { signal });
    this.read(eq.fragment.read());
  }

  disconnectedCallback() {
    this.stop.abort();
  }

  read(parameters) {
    for (const name of NAMES) {
      const control = this.form.elements[name];
      control.value = parameters.get(name) ?? "";
      if (control.selectedIndex === -1) control.value = "";
    }
    this.apply();
  }

  reset() {
    this.read(new URLSearchParams());
  }

  apply() {
    const wanted = Object.fromEntries(NAMES.map((name) => [name, this.form.elements[name].value]));
    const words = wanted.q.toLowerCase().split(/\s+/).filter(Boolean);
    this.table.classList.toggle("all-pairs", wanted.pairs === "all");
    this.table.classList.toggle("numbers-only", wanted.view === "numbers");
    for (const cell of this.table.querySelectorAll("[data-adapter]")) cell.hidden = Boolean(wanted.adapter) && cell.dataset.adapter !== wanted.adapter;
    let shown = 0;
    for (const row of this.rows) {
      row.hidden = !this.matches(row, wanted, words);
      shown += row.hidden ? 0 : 1;
    }
    this.order(wanted.sort);
    for (const group of this.groups) group.hidden = ![...group.rows].some((row) => row.classList.contains("row") && !row.hidden);
    this.form.querySelector("output").value = shown === this.rows.length ? `${shown} case${shown === 1 ? "" : "s"}` : `${shown} of ${this.rows.length} cases`;
    this.querySelector(".nothing").hidden = shown > 0 || this.rows.length === 0;
    eq.fragment.write(wanted);
  }

  matches(row, wanted, words) {
    const { search, family, features, statuses } = row.dataset;
    const cells = [...row.querySelectorAll("td.cell")].filter((cell) => !cell.hidden && (wanted.pairs === "all" || !cell.classList.contains("peer")));
    const status = wanted.adapter ? cells.map((cell) => cell.dataset.status) : statuses.split(" ");
    return words.every((word) => search.includes(word)) && (!wanted.family || family === wanted.family) && (!wanted.feature || features.split(" ").includes(wanted.feature))
      && (!wanted.status || status.includes(wanted.status)) && (!(wanted.verdict || wanted.finding || wanted.cause) || cells.some((cell) => isWanted(cell.dataset, wanted)));
  }

  // By family, each scene keeps its own rows; in any other order all rows stand in one body.
  order(sort) {
    if (sort === (this.sorted ?? "")) return;
    this.sorted = sort;
    this.table.classList.toggle("sorted", Boolean(sort));
    if (!sort) {
      this.homes.forEach((group, row) => group.append(row));
      return;
    }
    this.homes ??= new Map(this.rows.map((row) => [row, row.parentElement]));
    const number = (row) => Number(row.dataset[sort]);
    const by = sort === "name" ? (a, b) => a.dataset.case.localeCompare(b.dataset.case, "en", { numeric: true })
      : sort === "gravity" ? (a, b) => number(a) - number(b) || Number(b.dataset.en) - Number(a.dataset.en) : (a, b) => number(b) - number(a);
    this.groups[0].append(...[...this.rows].sort(by));
  }

  // Figures elsewhere on the page are links to the rows they count.
  follow(event) {
    const link = event.target.closest?.("a[data-filter]");
    if (!link) return;
    event.preventDefault();
    this.read(new URLSearchParams(link.dataset.filter));
    document.getElementById("matrix").scrollIntoView({ block: "start" });
  }

  key(event) {
    const { q } = this.form.elements;
    if (event.key === "Escape" && event.target === q) {
      q.value = "";
      this.apply();
    } else if (event.key === "ArrowDown" && event.target === q) {
      this.focusRow(0, 0, event);
    } else if (!eq.isTyping(event)) {
      if (event.key === "/") {
        event.preventDefault();
        q.focus();
        q.select();
      } else if (/^Arrow/.test(event.key) && event.target.closest("tr.row")) this.move(event);
    }
  }

  visibleRows() {
    return [...this.table.querySelectorAll("tr.row")].filter((row) => !row.hidden);
  }

  // Arrows move over the matrix: rows by rows, and through the links of a row.
  move(event) {
    const rows = this.visibleRows();
    const row = event.target.closest("tr.row");
    const links = linksOf(row);
    const column = links.indexOf(event.target.closest("a.go"));
    const [down, right] = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
    this.focusRow(Math.min(Math.max(rows.indexOf(row) + down, 0), rows.length - 1), column + right, event);
  }

  focusRow(index, column, event) {
    const row = this.visibleRows()[index];
    if (!row) return;
    event.preventDefault();
    const links = linksOf(row);
    links[Math.min(Math.max(column, 0), links.length - 1)].focus();
  }
});

// One cell has to be all that is asked for: the verdict of one render and the cause of another make no match.
const isWanted = ({ judged, finding, causes = "" }, wanted) => (!wanted.verdict || judged === wanted.verdict) && (!wanted.finding || finding === wanted.finding)
  && (!wanted.cause || causes.split("|").includes(wanted.cause));

const linksOf = (row) => [...row.querySelectorAll("a.go")].filter((link) => link.offsetParent !== null);
