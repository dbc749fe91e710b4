const faults = [];

function colour(text) {
  const parts = text.match(/[\d.]+/g).map(Number);
  const srgb = text.startsWith("color(");
  return [...parts.slice(0, 3).map((one) => (srgb ? one : one / 255)), parts[3] ?? 1];
}

function over(upper, lower) {
  return [0, 1, 2].map((i) => upper[i] * upper[3] + lower[i] * (1 - upper[3])).concat(1);
}

function luminance([r, g, b]) {
  const linear = (one) => (one <= 0.03928 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4);
  return 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
}

function contrast(one, other) {
  const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
}

/** The colour behind an element: all that its ancestors paint, the outermost first. */
function behind(element, view) {
  const layers = [];
  let opacity = 1;
  for (let one = element; one; one = one.parentElement) {
    const style = view.getComputedStyle(one);
    layers.unshift(colour(style.backgroundColor));
    opacity *= Number(style.opacity);
  }
  return [layers.reduce((lower, upper) => over(upper, lower), [1, 1, 1, 1]), opacity];
}

function look(frame) {
  const { name, width } = frame.dataset;
  const view = frame.contentWindow;
  const page = frame.contentDocument;
  const scheme = frame.style.colorScheme;
  const fault = (what, element) => {
    const place = element ? `: <${element.tagName.toLowerCase()} class="${element.className}"> ${element.textContent.trim().slice(0, 40)}` : "";
    faults.push(`${name}, ${width} px, ${scheme}: ${what}${place}`);
  };
  if (view.matchMedia("(prefers-color-scheme: dark)").matches !== (scheme === "dark")) fault("not shown in this scheme");
  const wide = page.documentElement.scrollWidth - view.innerWidth;
  if (wide > 0) fault(`${wide} px wider than the window`);
  if (!page.documentElement.lang) fault("no language");
  if (!page.title) fault("no title");
  if (!page.querySelector("meta[name=viewport]")) fault("no viewport");
  const shown = (element) => element.checkVisibility({ visibilityProperty: true }) && element.getClientRects().length > 0;
  if ([...page.querySelectorAll("h1")].filter(shown).length !== 1) fault("not one heading");
  const ids = [...page.querySelectorAll("[id]")].map((one) => one.id);
  if (new Set(ids).size < ids.length) fault("an id twice");
  const texts = page.createTreeWalker(page.body, NodeFilter.SHOW_TEXT);
  const seen = new Set();
  while (texts.nextNode()) {
    const element = texts.currentNode.parentElement;
    if (!texts.currentNode.data.trim() || seen.has(element) || !shown(element)) continue;
    seen.add(element);
    const style = view.getComputedStyle(element);
    const [ground, opacity] = behind(element, view);
    const ink = colour(element instanceof view.SVGElement ? style.fill : style.color);
    const ratio = contrast(over([...ink.slice(0, 3), ink[3] * opacity], ground), ground);
    if (ratio < 4.5) fault(`contrast ${ratio.toFixed(2)}`, element);
    if (parseFloat(style.fontSize) < 10) fault(`letters of ${style.fontSize}`, element);
  }
  for (const control of page.querySelectorAll("a[href], button, input, summary, [tabindex]")) {
    if (!shown(control)) continue;
    const label = control.getAttribute("aria-label") || control.title || control.textContent || [...(control.labels ?? [])].map((one) => one.textContent).join("");
    if (!label.trim()) fault("a control without a name", control);
    if (control.tabIndex < 0) fault("a control that keys do not reach", control);
  }
  for (const element of page.querySelectorAll("body *")) {
    const isCut = element.scrollWidth > element.clientWidth + 1 && /auto|scroll/.test(view.getComputedStyle(element).overflowX);
    if (isCut && shown(element) && element.tabIndex < 0 && !element.querySelector("a, button, input")) fault("keys do not scroll it", element);
  }
  const places = [...page.querySelectorAll("main .overlay")].filter(shown).map((one) => one.getBoundingClientRect());
  if (places.some((one) => one.left !== places[0].left || one.width !== places[0].width)) fault("charts side by side differ");
  const labels = [...page.querySelectorAll("main .label, main .tick, .threshold span, .scale")].filter(shown);
  for (const [at, label] of labels.entries()) {
    const one = label.getBoundingClientRect();
    const meets = (other) => one.left < other.right && other.left < one.right && one.top + 2 < other.bottom && other.top + 2 < one.bottom;
    if (labels.slice(at + 1).some((other) => meets(other.getBoundingClientRect()))) fault("labels collide", label);
  }
  for (const drawing of page.querySelectorAll("svg")) {
    if (!drawing.ariaHidden && drawing.getAttribute("role") !== "img") fault("a drawing without a role", drawing);
  }
}

addEventListener("load", () => {
  for (const frame of document.querySelectorAll("iframe")) look(frame);
  document.body.textContent = JSON.stringify(faults);
});
