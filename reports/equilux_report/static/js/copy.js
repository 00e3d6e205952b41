// A button that copies the text it stands over.
eq.define("eq-copy", class extends HTMLElement {
  connectedCallback() {
    if (this.querySelector("button")) return;
    const button = eq.element("button", { type: "button", class: "button copy" }, "copy");
    button.addEventListener("click", async () => {
      const pre = this.querySelector("pre");
      try {
        await navigator.clipboard.writeText(pre.textContent);
        button.textContent = "copied";
      } catch {
        getSelection().selectAllChildren(pre); // forbidden here: select it, the user's own keys copy
        button.textContent = "selected";
      }
      setTimeout(() => { button.textContent = "copy"; }, 1500);
    });
    this.prepend(button);
  }
});
