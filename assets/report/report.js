// Brings the parts together: what is shown, what is pointed at, and the controls.

(() => {
  const find = id => document.getElementById(id);
  const state = {
    coefficients: new Array(model.modes).fill(0),
    chosen: -1,       // the case that the view shows; -1: what the sliders say
    playing: -1,      // the mode that moves to and fro
    colouring: "landmarks",
    groups: [0, 1],
  };
  const scored = model.cases.length > 0 && model.cases.every(one => one.modes);
  const drawable = scored || model.cases.some((one, index) => model.shapeOfCase(index));

  // Colours.

  const normals = mesh => mesh.geometry.attributes.normal.array;
  let view = null, gallery = null, scatter = null, meanNormals = null;

  /// How far the shapes of the page lie from the mean at most, mm: the end of the scale.
  const farthest = (() => {
    let most = 0;
    const look = shape => {
      for (let v = 0; v < model.vertices; ++v) most = Math.max(most, movedBy(shape, v));
    };
    for (let m = 0; m < Math.min(model.modes, 3); ++m)
      for (const z of [-3, 3]) look(model.shapeOf(state.coefficients.map((_, k) => (k === m ? z : 0))));
    return scaleEnd(most);
  })();

  function movedBy(shape, v) {
    return Math.hypot(shape[3 * v] - model.mean[3 * v], shape[3 * v + 1] - model.mean[3 * v + 1], shape[3 * v + 2] - model.mean[3 * v + 2]);
  }

  /// How far the second group lies outside of the first at each vertex, mm.
  function outwardDifference() {
    const [from, to] = state.groups.map(k => model.groups[k]);
    const difference = model.groupDifference(from, to);
    return Float32Array.from({ length: model.vertices }, (_, v) =>
      [0, 1, 2].reduce((sum, c) => sum + difference[3 * v + c] * meanNormals[3 * v + c], 0));
  }

  const colourings = {
    landmarks: { name: "Landmarks", tip: "The same hue is the same place of the organ in every shape." },
    moved: { name: "Distance", tip: "How far each vertex lies from the mean shape." },
    doubt: { name: "Doubt", tip: "How far a vertex may lie from its place: root mean square over the cases." },
    groups: { name: "Groups", tip: "The mean of the second group lies outside the first where it is red, and inside where it is blue." },
  };

  /// The colours of a shape from its positions, and the legend's ends; made anew when the colouring changes.
  function makeTints() {
    const painted = colourOf => {
      const tints = new Float32Array(3 * model.vertices);
      for (let v = 0; v < model.vertices; ++v) tints.set(colourOf(v), 3 * v);
      return tints;
    };
    if (state.colouring === "moved") {
      return {
        of: shape => painted(v => onScale(model.scales.rising, movedBy(shape, v) / farthest)),
        legend: ["0 mm", `≥ ${farthest} mm`, "from the mean", model.scales.rising],
      };
    }
    if (state.colouring === "doubt") {
      const most = scaleEnd(model.doubt.reduce((a, b) => Math.max(a, b), 0));
      const tints = painted(v => onScale(model.scales.doubt, model.doubt[v] / most));
      return { of: () => tints, legend: ["0 mm", `${most} mm`, "doubt", model.scales.doubt] };
    }
    if (state.colouring === "groups") {
      const outward = outwardDifference(), most = scaleEnd(outward.reduce((a, b) => Math.max(a, Math.abs(b)), 0));
      const tints = painted(v => onScale(model.scales.diverging, 0.5 + outward[v] / (2 * most)));
      const [from, to] = state.groups.map(k => model.groups[k]);
      return { of: () => tints, legend: [`−${most} mm`, `+${most} mm`, `${to} against ${from}, outward`, model.scales.diverging] };
    }
    const tints = painted(v => hueColour(model.hues[v], 0.4));
    return { of: () => tints, legend: null };
  }

  let tints = makeTints();

  function showLegend() {
    const legend = find("legend"), [low, bar, high, title] = legend.children;
    legend.hidden = !tints.legend;
    if (!tints.legend) return;
    [low.textContent, high.textContent, title.textContent] = tints.legend;
    const rgb = colour => `rgb(${colour.map(c => Math.round(255 * c)).join(" ")})`;
    bar.style.background = `linear-gradient(to right, ${tints.legend[3].map(rgb).join(", ")})`;
  }

  function recolour() {
    tints = makeTints();
    showLegend();
    find("colour-tip").textContent = colourings[state.colouring].tip;
    find("group-pair").hidden = state.colouring !== "groups";
    for (const button of find("colourings").children)
      button.setAttribute("aria-pressed", button.dataset.colouring === state.colouring);
    paintView();
    if (gallery) gallery.paint(tints.of);
    showLandmarks();
  }

  /// In the small shapes of the gallery they would hide a colouring that says something else.
  function showLandmarks() {
    view.shape.dots.visible = find("glyphs").checked;
    if (gallery) gallery.landmarks = find("glyphs").checked && state.colouring === "landmarks";
    turned();
  }

  function paintView() {
    view.shape.paint(tints.of(view.shape.positions));
    view.drawSoon();
  }

  // The shape in the view.

  function showShape() {
    if (!view) return;
    if (state.chosen >= 0) view.shape.positions.set(model.shapeOfCase(state.chosen));
    else model.shapeOf(state.coefficients, view.shape.positions);
    view.shape.moved();
    paintView();
    showArrows();
    tellShown(-1);
  }

  function tellShown(vertex) {
    const one = model.cases[state.chosen];
    const moved = state.coefficients.map((value, m) => (value !== 0 ? `mode ${m + 1} ${signed(value)}` : "")).filter(Boolean);
    let text = one ? `${one.name}${one.group ? ` (${one.group})` : ""}` : moved.length > 0 ? `${moved.join(", ")} SD` : "Mean shape";
    if (vertex >= 0) {
      text += `\nvertex ${vertex}: ${movedBy(view.shape.positions, vertex).toFixed(2)} mm from the mean`;
      if (model.doubt) text += `, doubt ${model.doubt[vertex].toFixed(2)} mm`;
    }
    find("shown").textContent = text;
  }

  const sliders = [];

  function setCoefficient(mode, value) {
    state.coefficients[mode] = value;
    sliders[mode].input.value = value;
    sliders[mode].output.textContent = signed(value);
  }

  function leaveCase() {
    if (state.chosen >= 0) choose(-1);
  }

  function makeSliders() {
    for (let m = 0; m < model.modes; ++m) {
      const row = document.createElement("div"), name = document.createElement("span"), share = document.createElement("small");
      const input = document.createElement("input"), output = document.createElement("output"), play = document.createElement("button");
      row.className = "slider";
      name.textContent = `Mode ${m + 1} `;
      share.textContent = `${(100 * model.variances[m] / model.totalVariance).toFixed(1)} %`;
      name.append(share);
      Object.assign(input, { type: "range", min: -3, max: 3, step: 0.05, value: 0 });
      input.setAttribute("aria-label", `Mode ${m + 1}, standard deviations`);
      output.textContent = signed(0);
      play.type = "button";
      play.textContent = "▸";
      play.setAttribute("aria-label", `Play mode ${m + 1}`);
      play.setAttribute("aria-pressed", "false");
      input.addEventListener("input", () => {
        const value = Number(input.value);
        stop();
        leaveCase();  // which sets all sliders to 0
        setCoefficient(m, value);
        showShape();
      });
      play.addEventListener("click", () => (state.playing === m ? stop() : start(m)));
      row.append(name, input, output, play);
      find("sliders").append(row);
      sliders.push({ input, output, play });
    }
  }

  // Playing: a mode goes to and fro in four seconds.

  let begun = 0;

  function start(mode) {
    stop();
    leaveCase();
    state.playing = mode;
    sliders[mode].play.setAttribute("aria-pressed", "true");
    sliders[mode].play.textContent = "❚❚";
    begun = performance.now() - 4000 / (2 * Math.PI) * Math.asin(Math.max(-1, Math.min(1, state.coefficients[mode] / 3)));
    requestAnimationFrame(step);
  }

  function step(now) {
    if (state.playing < 0) return;
    setCoefficient(state.playing, 3 * Math.sin((now - begun) * 2 * Math.PI / 4000));
    showShape();
    requestAnimationFrame(step);
  }

  function stop() {
    if (state.playing < 0) return;
    sliders[state.playing].play.setAttribute("aria-pressed", "false");
    sliders[state.playing].play.textContent = "▸";
    state.playing = -1;
  }

  /// Numbers of a normal distribution.
  const normal = () => Math.sqrt(-2 * Math.log(1 - Math.random())) * Math.cos(2 * Math.PI * Math.random());

  function setAll(valueOf) {
    stop();
    leaveCase();
    for (let m = 0; m < model.modes; ++m) setCoefficient(m, Math.min(Math.max(valueOf(m), -3), 3));
    showShape();
  }

  // Cases: what is pointed at is lit everywhere, what is chosen is shown in the view.

  const rows = model.rows.map(row => document.querySelector(`#cases tr[data-case="${row}"]`));

  function highlight(index, className) {
    rows.forEach((row, k) => row.classList.toggle(className, k === index));
    if (gallery) gallery.highlight(index, className);
    if (scatter) scatter.highlight(index, className);
  }

  function point(index, fromGallery = false) {
    highlight(index, "on");
    if (index >= 0 && gallery && !fromGallery) gallery.bringIntoView(index);
  }

  function pointVertex(vertex) {
    if (view) view.shape.markVertex(vertex), view.drawSoon(), tellShown(vertex);
    if (gallery) gallery.mark(vertex);
  }

  function choose(index) {
    stop();
    state.chosen = index === state.chosen ? -1 : index;
    highlight(state.chosen, "chosen");
    const scores = state.chosen >= 0 ? model.cases[state.chosen].modes : null;
    for (let m = 0; m < model.modes; ++m) setCoefficient(m, scores ? scores[m] : 0);
    showShape();
  }

  // Around the view.

  function showScale() {
    const { up, right } = lookDirection(), bar = find("scale-bar");
    for (const [id, direction] of [["top", up], ["bottom", up.clone().negate()], ["right", right], ["left", right.clone().negate()]])
      find(`side-${id}`).textContent = sideLetters(direction);
    const wanted = 90 * view.mmPerPixel, power = 10 ** Math.floor(Math.log10(wanted));
    const length = [5, 2, 1].map(digit => digit * power).find(mm => mm <= wanted) || power;
    bar.firstElementChild.style.width = `${length / view.mmPerPixel}px`;
    bar.lastElementChild.textContent = `${Number(length.toPrecision(3))} mm`;
  }

  function turned() {
    view.drawSoon();
    if (gallery) gallery.drawSoon();
  }

  function showArrows() {
    if (!find("arrows").checked && !view.arrows) return;
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    view.showArrows(find("arrows").checked ? arrowGeometry(view.shape.positions, Number(find("arrow-mode").value), 3, dark ? [0.96, 0.97, 0.98] : [0.1, 0.11, 0.13]) : null);
    view.drawSoon();
  }

  function options(select, names, chosen) {
    select.replaceChildren(...names.map((name, k) => new Option(name, k, false, k === chosen)));
  }

  function makeControls() {
    const offered = ["landmarks", "moved"].concat(model.doubt ? ["doubt"] : [], model.groups.length > 1 && drawable ? ["groups"] : []);
    for (const key of offered) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = colourings[key].name;
      button.dataset.colouring = key;
      button.addEventListener("click", () => ((state.colouring = key), recolour()));
      find("colourings").append(button);
    }
    ["group-from", "group-to"].forEach((id, k) => {
      options(find(id), model.groups, state.groups[k]);
      find(id).addEventListener("change", () => ((state.groups[k] = Number(find(id).value)), recolour()));
    });
    options(find("arrow-mode"), model.variances.slice(0, model.modes).map((_, m) => String(m + 1)), 0);
    find("arrows").addEventListener("change", showArrows);
    find("arrow-mode").addEventListener("change", () => ((find("arrows").checked = true), showArrows()));
    find("glyphs").addEventListener("change", showLandmarks);
    find("reset").addEventListener("click", () => setAll(() => 0));
    find("random").addEventListener("click", () => setAll(normal));
    find("save").addEventListener("click", savePicture);
    for (const button of document.querySelectorAll("[data-look]"))
      button.addEventListener("click", () => {
        [turn.around, turn.above] = button.dataset.look.split(" ").map(Number);
        turned();
      });
    find("zoom-in").addEventListener("click", () => (zoomBy(1.25), turned()));
    find("zoom-out").addEventListener("click", () => (zoomBy(0.8), turned()));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", showArrows);
  }

  function savePicture() {
    view.draw();
    view.canvas.toBlob(blob => {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(blob);
      link.download = "shape.png";
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
  }

  function listen() {
    const canvas = view.canvas;
    turnByPointer(canvas, {
      turned,
      clicked: event => pointVertex(view.vertexAt(event)),
      over: event => pointVertex(view.vertexAt(event)),
      left: () => pointVertex(-1),
    });
    canvas.addEventListener("wheel", event => {
      if (!event.ctrlKey && document.activeElement !== canvas) return;  // the wheel scrolls the page
      event.preventDefault();
      zoomBy(Math.exp(-0.002 * event.deltaY));
      turned();
    }, { passive: false });
    canvas.addEventListener("keydown", event => {
      const act = {
        ArrowLeft: () => turnBy(-6, 0), ArrowRight: () => turnBy(6, 0), ArrowUp: () => turnBy(0, 6), ArrowDown: () => turnBy(0, -6),
        "+": () => zoomBy(1.25), "-": () => zoomBy(0.8), "0": () => Object.assign(turn, { around: 0, above: 0, zoom: 1 }),
      }[event.key];
      if (!act) return;
      event.preventDefault();
      act();
      turned();
    });
  }

  function makeCases() {
    rows.forEach((row, index) => {
      row.addEventListener("pointerenter", () => point(index));
      row.addEventListener("pointerleave", () => point(-1));
      if (drawable && view) row.addEventListener("click", () => choose(index));
    });
    if (!scored) find("scatter-figure").hidden = true;
    else {
      scatter = new Scatter(find("scatter"), find("scatter-readout"), { pointed: point, chosen: index => view && choose(index) });
      ["scatter-x", "scatter-y"].forEach((id, axis) => {
        options(find(id), model.variances.slice(0, model.modes).map((_, m) => String(m + 1)), scatter.axes[axis]);
        find(id).addEventListener("change", () => {
          scatter.axes[axis] = Number(find(id).value);
          scatter.draw();
          highlight(state.chosen, "chosen");
        });
      });
    }
    if (!drawable || !view) find("gallery").hidden = true;
    else
      gallery = new Gallery(find("gallery"), {
        turned,
        chosen: choose,
        pointed: (index, vertex) => (point(index, true), pointVertex(vertex)),
      });
    if (model.cases.length === 0) find("cases-section").hidden = true;
  }

  function copyMethods() {
    const text = find("methods").innerText, button = find("copy");
    const tell = what => {
      button.textContent = what;
      setTimeout(() => (button.textContent = "Copy text"), 1500);
    };
    const select = () => (getSelection().selectAllChildren(find("methods")), tell("Selected: press Ctrl+C"));
    if (navigator.clipboard) navigator.clipboard.writeText(text).then(() => tell("Copied"), select);
    else select();
  }

  /// The page carries how it was made. What it was made of stands here as well.
  function listInputs() {
    const record = document.getElementById("homolog.record"), inputs = [];
    if (!record) return;
    const gather = one => {
      if (one === null || typeof one !== "object") return;
      if (one.sha256) inputs.push(one);
      Object.values(one).forEach(gather);
    };
    gather(JSON.parse(record.textContent).options);
    for (const one of inputs) {
      const row = find("inputs").querySelector("tbody").insertRow(), name = document.createElement("th");
      name.textContent = one.file;
      row.append(name);
      Object.assign(row.insertCell(), { textContent: one.sha256, className: "word hash" });
    }
    find("inputs").hidden = inputs.length === 0;
  }

  // WebGL may be missing or switched off: then the picture of the modes stands in its place.
  try {
    view = new ShapeView(find("view"));
    meanNormals = new Float32Array(normals(view.shape));
    view.drawn = showScale;
  } catch (error) {
    document.documentElement.classList.add("no-webgl");
    view = null;
  }
  find("plots").append(...plotsOfModel());
  if (model.measurements.length > 0) find("measurements").append(...plotsOfMeasurements());
  makeSliders();
  makeCases();
  if (view) {
    makeControls();
    listen();
    recolour();
    showShape();
  }
  listInputs();
  find("copy").addEventListener("click", copyMethods);

  // What the tests of the page ask for.
  window.homologReport = {
    positions: () => Array.from(view.shape.positions),
  };
})();
