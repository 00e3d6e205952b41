// The page's state lives in the URL's fragment, the one part that a page from file:// may change.
eq.fragment = {
  read: () => new URLSearchParams(location.hash.slice(1)),

  // Keep the keys that others own; set those given; drop those that are empty or null.
  write(changes) {
    const parameters = this.read();
    for (const [key, value] of Object.entries(changes)) {
      if (value === null || value === "") parameters.delete(key);
      else parameters.set(key, value);
    }
    const text = parameters.toString();
    if (text !== location.hash.slice(1)) history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
  },
};

// Links within the page scroll, and leave the fragment to the state.
document.addEventListener("click", (event) => {
  const link = event.target.closest?.("a[data-scroll]");
  if (!link) return;
  event.preventDefault();
  const target = document.getElementById(link.hash.slice(1));
  target?.scrollIntoView({ block: "start" });
  target?.focus({ preventScroll: true });
});
