// In a single-file report every case and every other page lies in a template; the fragment's `case` or `page` says which one is shown.
eq.whenReady(() => {
  const keyOf = ({ case: name, page }) => (name ? `case ${name}` : page ? `page ${page}` : null);
  const templates = new Map([...document.querySelectorAll("template[data-case], template[data-page]")].map((template) => [keyOf(template.dataset), template]));
  if (!templates.size) return;
  const main = document.getElementById("main");
  const nav = document.querySelector(".top__nav");
  const home = { title: document.title, main: [...main.childNodes], nav: [...nav.childNodes] };
  let shown = null;

  const route = () => {
    const name = keyOf(Object.fromEntries(eq.fragment.read()));
    const wanted = templates.has(name) ? name : null;
    if (wanted === shown) return;
    shown = wanted;
    const template = templates.get(wanted);
    const content = template ? document.importNode(template.content, true) : null;
    document.title = template ? template.dataset.title : home.title;
    main.replaceChildren(...(content ? content.querySelector("main").childNodes : home.main));
    nav.replaceChildren(...(content ? content.querySelector("nav").childNodes : home.nav));
    scrollTo(0, 0);
  };
  window.addEventListener("hashchange", route);
  route();
});
