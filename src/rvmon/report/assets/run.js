"use strict";
(() => {
  const run = JSON.parse(document.getElementById("run").textContent);
  const main = document.querySelector("main");
  const rows = [...document.querySelectorAll("nav .row[href]")];
  const here = document.querySelector("nav .here");
  const runCursor = document.querySelector("nav .cursor");
  const sections = [...main.querySelectorAll("section")];
  const scene = run.scene && readScene(run.scene);
  const bodies = [...document.querySelectorAll(".scene [data-body]")];
  let open = null;
  let instant = 0;
  let playing = 0;

  document.documentElement.dataset.script = "";
  main.dataset.script = "";

  // --- one attempt at a time ----------------------------------------------------------------

  function show(id) {
    const section =
      sections.find((one) => one.id === id) ||
      sections.find((one) => requirement(one) === id) ||
      sections.find((one) => one.id === main.dataset.open);
    stop();
    open = section;
    for (const one of sections) one.classList.toggle("open", one === section);
    for (const row of rows) {
      const mine = sections.find((one) => "#" + one.id === row.getAttribute("href"));
      const current = requirement(mine) === requirement(section);
      if (current) {
        row.setAttribute("aria-current", "true");
        row.closest(".all").scrollTop = row.offsetTop - row.offsetHeight;
      }
      else row.removeAttribute("aria-current");
    }
    const panel = run.panels[section.id];
    here.style.left = 100 * Math.max(share(panel.start), 0) + "%";
    here.style.right = 100 * Math.max(1 - share(panel.end), 0) + "%";
    document.title = section.querySelector("h1").textContent;
    setInstant(run.panels[section.id].instant);
  }

  /** The place of an instant in the whole run, 0 to 1. */
  function share(t) {
    return (t - run.start) / (run.end - run.start);
  }

  function requirement(section) {
    return run.panels[section.id].requirement;
  }

  function fromAddress() {
    show(decodeURIComponent(location.hash.slice(1)));
  }

  // --- the cursor ---------------------------------------------------------------------------

  function setFraction(fraction) {
    const panel = run.panels[open.id];
    setInstant(panel.start + Math.min(Math.max(fraction, 0), 1) * (panel.end - panel.start));
  }

  function setInstant(t) {
    const panel = run.panels[open.id];
    const fraction = (t - panel.start) / (panel.end - panel.start);
    instant = t;
    for (const cursor of open.querySelectorAll(".cursor")) cursor.style.left = 100 * fraction + "%";
    runCursor.style.left = 100 * Math.min(Math.max(share(t), 0), 1) + "%";
    open.querySelector("input").value = Math.round(1000 * fraction);
    open.querySelector(".instant").textContent = reading(instant, panel.trigger);
    for (const output of open.querySelectorAll("output[data-track]")) {
      output.textContent = valueAt(panel.tracks[output.dataset.track], instant);
    }
    drawScene(instant);
  }

  function reading(t, trigger) {
    if (trigger === null) return `${shown(t)} s`;
    const since = shown(Math.abs(t - trigger));
    const sign = t < trigger && since !== "0" ? "−" : "+";
    return `${shown(t)} s, trigger ${sign} ${since} s`;
  }

  function shown(number) {
    return String(Number(number.toFixed(3)));
  }

  function valueAt(track, t) {
    const value = track.v[lastBefore(track.t, t)];
    if (value === null || value === undefined) return "unknown";
    const text = typeof value === "number" ? String(Number(value.toPrecision(4))) : String(value);
    return track.unit ? `${text} ${track.unit}` : text;
  }

  function lastBefore(times, t) {
    let low = 0;
    let high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  function follow(event) {
    const plot = open.querySelector(".overlay").getBoundingClientRect();
    setFraction((event.clientX - plot.left) / plot.width);
  }

  // --- the scene ----------------------------------------------------------------------------

  function readScene(packed) {
    const sum = (differences) => {
      let total = 0;
      return differences.map((one) => (total += one));
    };
    return { times: sum(packed.times), values: packed.values.map(sum) };
  }

  function drawScene(t) {
    if (!scene || scene.times.length === 0) return;
    const milliseconds = 1000 * t;
    const before = Math.max(lastBefore(scene.times, milliseconds), 0);
    const after = Math.min(before + 1, scene.times.length - 1);
    const gap = scene.times[after] - scene.times[before];
    const moving = gap > 0 && gap <= 250;
    const share = moving ? Math.min(Math.max((milliseconds - scene.times[before]) / gap, 0), 1) : 0;
    const value = (column) => {
      const series = scene.values[column];
      return series[before] + share * (series[after] - series[before]);
    };
    for (const body of bodies) {
      const first = 3 * Number(body.dataset.body);
      const degrees = (-value(first + 2) * 180) / (1000 * Math.PI);
      body.setAttribute("transform", `translate(${value(first)} ${-value(first + 1)}) rotate(${degrees})`);
    }
  }

  // --- playing ------------------------------------------------------------------------------

  function play() {
    const panel = run.panels[open.id];
    if (instant >= panel.end - 1e-9) setFraction(0);
    const speed = Math.max((panel.end - panel.start) / 12, 1);
    let last = null;
    const step = (now) => {
      const next = instant + ((now - (last ?? now)) / 1000) * speed;
      last = now;
      setFraction((next - panel.start) / (panel.end - panel.start));
      if (next >= panel.end) stop();
      else playing = requestAnimationFrame(step);
    };
    playing = requestAnimationFrame(step);
    open.querySelector(".play").textContent = speed > 1.05 ? `❚❚ ${shown(Math.round(speed))}×` : "❚❚ pause";
  }

  function stop() {
    if (!open) return;
    cancelAnimationFrame(playing);
    playing = 0;
    open.querySelector(".play").textContent = "▶ play";
  }

  function toggle() {
    if (playing) stop();
    else play();
  }

  // --- events -------------------------------------------------------------------------------

  for (const section of sections) {
    section.querySelector("input").addEventListener("input", (event) => {
      stop();
      setFraction(event.target.value / 1000);
    });
    section.querySelector(".play").addEventListener("click", toggle);
    const plots = section.querySelector(".timeline");
    plots.addEventListener("pointerdown", (event) => {
      stop();
      follow(event);
    });
    plots.addEventListener("pointermove", (event) => {
      if (event.buttons || (event.pointerType === "mouse" && !playing)) follow(event);
    });
  }
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|BUTTON|SUMMARY|A)$/.test(event.target.tagName)) return;
    const panel = run.panels[open.id];
    const at = (instant - panel.start) / (panel.end - panel.start);
    if (event.key === " ") toggle();
    else if (event.key === "ArrowLeft") setFraction(at - 0.005);
    else if (event.key === "ArrowRight") setFraction(at + 0.005);
    else return;
    event.preventDefault();
  });
  for (const row of rows) {
    row.addEventListener("click", (event) => {
      const plot = row.querySelector(".plot").getBoundingClientRect();
      if (event.detail === 0 || event.clientX < plot.left) return;
      const t = run.start + ((event.clientX - plot.left) / plot.width) * (run.end - run.start);
      const name = requirement(sections.find((one) => "#" + one.id === row.getAttribute("href")));
      const far = (section) => {
        const panel = run.panels[section.id];
        return Math.max(panel.trigger - t, t - panel.instant, 0);
      };
      const own = sections.filter((one) => requirement(one) === name).sort((a, b) => far(a) - far(b));
      event.preventDefault();
      location.hash = own[0].id;
    });
  }
  const copy = document.querySelector(".copy");
  copy.addEventListener("click", () => {
    const range = document.createRange();
    range.selectNodeContents(document.getElementById("command"));
    getSelection().removeAllRanges();
    getSelection().addRange(range);
    document.execCommand("copy");
    copy.textContent = "copied";
  });
  addEventListener("hashchange", fromAddress);
  fromAddress();
})();
