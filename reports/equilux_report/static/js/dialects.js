// The page of dialects: one renderer's or all, as the fragment says; long lists of evidence open on demand.
eq.define("eq-dialects", class extends HTMLElement {
  connectedCallback() {
    this.stop = new AbortController();
    const { signal } = this.stop;
    window.addEventListener("hashchange", () => this.show(), { signal });
    this.addEventListener("click", (event) => this.more(event), { signal });
    this.show();
  }

  disconnectedCallback() {
    this.stop.abort();
  }

  show() {
    const wanted = eq.fragment.read().get("adapter");
    const sections = [...this.querySelectorAll("[data-dialect]")];
    const isKnown = sections.some((section) => section.dataset.dialect === wanted);
    for (const section of sections) section.hidden = isKnown && section.dataset.dialect !== wanted;
    for (const pick of this.querySelectorAll("[data-pick]")) {
      if (pick.dataset.pick === (isKnown ? wanted : "")) pick.setAttribute("aria-current", "true");
      else pick.removeAttribute("aria-current");
    }
  }

  more(event) {
    const button = event.target.closest("[data-more]");
    if (!button) return;
    const rows = button.parentElement.querySelector("tbody.more");
    rows.hidden = !rows.hidden;
    button.setAttribute("aria-expanded", String(!rows.hidden));
    button.hidden = true;
  }
});
