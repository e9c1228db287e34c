// Plots as SVG, with the value under the pointer in a line below.

function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/// Round values from `low` to `high`, about five of them.
function ticks(low, high) {
  const step = roundedUp((high - low) / 5), values = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9); ++k) values.push(Number((k * step).toPrecision(12)));
  return values;
}

/// A plot over the number of modes. `series`: values and errors by mode, from 1; `bars`: of each mode alone.
/// `say(m)`: the line for mode m.
function modePlot({ title, unit, series, bars, top, limit, say }) {
  const width = 360, height = 190, left = 44, right = 8, above = 8, below = 28;
  const count = series.length;
  const most = Math.max(...series.map(([value, error]) => value + error)), step = roundedUp(most / 5);
  const high = top || step * Math.ceil(most / step);
  const x = m => left + (m - 0.5) * (width - left - right) / count;
  const y = value => height - below - value * (height - above - below) / high;
  const picture = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title, tabindex: 0 });
  for (const value of ticks(0, high)) {
    picture.append(svg("line", { class: "grid", x1: left, x2: width - right, y1: y(value), y2: y(value) }),
      svg("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" }, String(value)));
  }
  const every = Math.max(1, Math.ceil(count / 10));
  for (let m = 1; m <= count; m += every)
    picture.append(svg("text", { x: x(m), y: height - below + 16, "text-anchor": "middle" }, String(m)));
  if (limit) picture.append(svg("line", { class: "limit", x1: left, x2: width - right, y1: y(limit), y2: y(limit) }));
  const wide = 0.7 * (width - left - right) / count;
  const barElements = (bars || []).map((value, k) =>
    svg("rect", { class: "bar", x: x(k + 1) - wide / 2, y: y(value), width: wide, height: Math.max(0, y(0) - y(value)) }));
  picture.append(...barElements);
  const path = points => "M" + points.map(([px, py]) => `${px.toFixed(2)} ${py.toFixed(2)}`).join("L");
  const edge = sign => series.map(([value, error], k) => [x(k + 1), y(Math.min(high, Math.max(0, value + sign * error)))]);
  picture.append(svg("path", { class: "band", d: path([...edge(1), ...edge(-1).reverse()]) + "Z" }),
    svg("path", { class: "line", d: path(series.map(([value], k) => [x(k + 1), y(value)])) }));
  const dot = svg("circle", { class: "dot", r: 4 });
  picture.append(dot);
  const readout = document.createElement("p");
  readout.className = "readout";
  let at = 0;
  const show = m => {
    at = Math.min(Math.max(m, 1), count);
    dot.setAttribute("cx", x(at));
    dot.setAttribute("cy", y(series[at - 1][0]));
    barElements.forEach((bar, k) => bar.classList.toggle("on", k === at - 1));
    readout.textContent = say(at);
  };
  const modeAt = event => {
    const box = picture.getBoundingClientRect();
    return Math.floor(((event.clientX - box.left) * width / box.width - left) / ((width - left - right) / count)) + 1;
  };
  picture.addEventListener("pointermove", event => show(modeAt(event)));
  picture.addEventListener("pointerdown", event => show(modeAt(event)));
  picture.addEventListener("keydown", event => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (step) event.preventDefault(), show(at + step);
  });
  show(Math.min(model.modes, count));
  const figure = document.createElement("figure"), caption = document.createElement("figcaption"), small = document.createElement("small");
  caption.textContent = title + " ";
  small.textContent = unit;
  caption.append(small);
  figure.append(caption, picture, readout);
  return figure;
}

function plotsOfModel() {
  const percent = value => `${(100 * value).toFixed(1)} %`;
  const shares = model.variances.map(value => value / model.totalVariance);
  let sum = 0;
  const together = shares.map(share => (sum += share));
  const shown = Math.min(shares.length, Math.max(model.modes, together.findIndex(value => value > 0.995) + 1 || shares.length));
  const plots = [modePlot({
    title: "Compactness", unit: "% of the variance, by modes", top: 100, limit: 95,
    series: together.slice(0, shown).map(value => [100 * value, 0]),
    bars: shares.slice(0, shown).map(share => 100 * share),
    say: m => `Mode ${m} holds ${percent(shares[m - 1])}; modes 1 to ${m} hold ${percent(together[m - 1])}`,
  })];
  const measured = (title, series, what) => modePlot({
    title, unit: "mm, by modes", series: series.slice(0, shown),
    say: m => `With ${m} ${m === 1 ? "mode" : "modes"} ${series[m - 1][0].toFixed(2)} ± ${series[m - 1][1].toFixed(2)} mm ${what}`,
  });
  if (model.generalisation.length > 0) {
    plots.push(measured("Generalisation", model.generalisation, "to a shape left out"));
    plots.push(measured("Specificity", model.specificity, "to the nearest shape"));
  }
  return plots;
}

/// A measurement along the first modes, a line each, with the value under the pointer in a line below.
function measurementPlot({ name, values, texts }) {
  const width = 360, height = 190, left = 44, right = 8, above = 8, below = 28;
  const most = (values[0].length - 1) / 2, known = values.flat().filter(value => value !== null);
  const least = Math.min(...known), range = Math.max(...known) - least || Math.max(1, Math.abs(least));
  const step = roundedUp(range / 5), low = step * Math.floor(least / step + 1e-9);
  const high = Math.max(low + step, step * Math.ceil((least + range) / step - 1e-9));
  const x = sd => left + (sd + most) * (width - left - right) / (2 * most);
  const y = value => height - below - (value - low) * (height - above - below) / (high - low);
  const picture = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": name, tabindex: 0 });
  for (const value of ticks(low, high))
    picture.append(svg("line", { class: "grid", x1: left, x2: width - right, y1: y(value), y2: y(value) }),
      svg("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" }, String(value).replace("-", "−")));
  for (let sd = -most; sd <= most; ++sd)
    picture.append(svg("text", { x: x(sd), y: height - below + 16, "text-anchor": "middle" }, String(sd).replace("-", "−")));
  values.forEach((line, mode) => {
    const points = line.map((value, k) => [k - most, value]).filter(([, value]) => value !== null);
    const path = "M" + points.map(([sd, value]) => `${x(sd).toFixed(2)} ${y(value).toFixed(2)}`).join("L");
    picture.append(svg("path", { class: "line", d: path, style: `stroke: var(--group-${mode})` }),
      ...points.map(([sd, value]) => svg("path", {
        d: groupMarks[mode](3.5), style: `fill: var(--group-${mode})`, transform: `translate(${x(sd).toFixed(2)} ${y(value).toFixed(2)})`,
      })));
  });
  const at = svg("line", { class: "axis", y1: above, y2: height - below });
  picture.append(at);
  const readout = document.createElement("p");
  readout.className = "readout";
  let now = 0;
  const show = sd => {
    now = Math.min(Math.max(sd, -most), most);
    for (const end of ["x1", "x2"]) at.setAttribute(end, x(now));
    readout.textContent = now === 0 ? `Mean: ${texts[0][most]}`
      : `At ${now < 0 ? "−" : "+"}${Math.abs(now)} SD: ` + texts.map((line, mode) => `mode ${mode + 1} ${line[now + most]}`).join(", ");
  };
  const under = event => {
    const box = picture.getBoundingClientRect();
    return Math.round(((event.clientX - box.left) * width / box.width - left) * 2 * most / (width - left - right)) - most;
  };
  picture.addEventListener("pointermove", event => show(under(event)));
  picture.addEventListener("pointerdown", event => show(under(event)));
  picture.addEventListener("keydown", event => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (step) event.preventDefault(), show(now + step);
  });
  show(0);
  const figure = document.createElement("figure"), caption = document.createElement("figcaption"), small = document.createElement("small");
  caption.textContent = name + " ";
  small.textContent = "by standard deviations of the modes";
  caption.append(small);
  const keys = document.createElement("div");
  keys.className = "keys";
  values.forEach((_, mode) => {
    const key = document.createElement("span");
    key.append(svg("svg", { viewBox: "-7 -7 14 14" }, svg("path", { d: groupMarks[mode](5), style: `fill: var(--group-${mode})` })), `mode ${mode + 1}`);
    keys.append(key);
  });
  figure.append(caption, picture, keys, readout);
  return figure;
}

const plotsOfMeasurements = () =>
  model.measurements.filter(one => one.values.flat().some(value => value !== null)).map(measurementPlot);

const groupMarks = [
  r => `M${-r} 0A${r} ${r} 0 1 0 ${r} 0A${r} ${r} 0 1 0 ${-r} 0Z`,
  r => `M${-r} ${-r}H${r}V${r}H${-r}Z`,
  r => `M0 ${-1.25 * r}L${1.2 * r} ${r}H${-1.2 * r}Z`,
  r => `M0 ${-1.4 * r}L${1.4 * r} 0L0 ${1.4 * r}L${-1.4 * r} 0Z`,
  r => `M0 ${1.25 * r}L${1.2 * r} ${-r}H${-1.2 * r}Z`,
  r => `M${-r} ${-r / 3}H${-r / 3}V${-r}H${r / 3}V${-r / 3}H${r}V${r / 3}H${r / 3}V${r}H${-r / 3}V${r / 3}H${-r}Z`,
];
const markOf = group => Math.max(0, model.groups.indexOf(group)) % groupMarks.length;
const groupColour = group => `var(--group-${markOf(group)})`;

/// Cases by their scores on two modes.
class Scatter {
  constructor(box, readout, { pointed, chosen }) {
    this.box = box;
    this.readout = readout;
    this.axes = [0, Math.min(1, model.modes - 1)];
    this.asked = { pointed, chosen };
    this.draw();
  }

  draw() {
    const size = 380, edge = 30, inset = 10;
    const values = axis => model.cases.map(one => one.modes[this.axes[axis]]);
    const reach = Math.max(2.2, ...[0, 1].flatMap(axis => values(axis).map(Math.abs))) * 1.08;
    const x = value => edge + (value + reach) * (size - edge - inset) / (2 * reach);
    const y = value => size - edge - (value + reach) * (size - edge - inset) / (2 * reach);
    const picture = svg("svg", { viewBox: `0 0 ${size} ${size}`, role: "group", "aria-label": "Scores of the cases" });
    for (let value = -Math.floor(reach); value <= reach; ++value) {
      const line = value === 0 ? "axis" : "grid", text = String(value).replace("-", "−");
      picture.append(svg("line", { class: line, x1: x(value), x2: x(value), y1: inset, y2: size - edge }),
        svg("line", { class: line, x1: edge, x2: size - inset, y1: y(value), y2: y(value) }),
        svg("text", { x: x(value), y: size - edge + 16, "text-anchor": "middle" }, text),
        svg("text", { x: edge - 6, y: y(value) + 4, "text-anchor": "end" }, text));
    }
    this.points = model.cases.map((one, index) => {
      const point = svg("path", {
        class: "point", d: groupMarks[markOf(one.group)](5), style: `fill: ${groupColour(one.group)}`,
        transform: `translate(${x(one.modes[this.axes[0]]).toFixed(2)} ${y(one.modes[this.axes[1]]).toFixed(2)})`,
      }, svg("title", {}, one.name));
      point.addEventListener("pointerenter", () => this.asked.pointed(index));
      point.addEventListener("pointerleave", () => this.asked.pointed(-1));
      point.addEventListener("click", () => this.asked.chosen(index));
      return point;
    });
    picture.append(...this.points);
    this.box.replaceChildren(picture);
    if (model.groups.length > 0) this.box.append(this.keys());
  }

  keys() {
    const keys = document.createElement("div");
    keys.className = "keys";
    for (const group of model.groups) {
      const key = document.createElement("span");
      key.append(svg("svg", { viewBox: "-7 -7 14 14" }, svg("path", { d: groupMarks[markOf(group)](5), style: `fill: ${groupColour(group)}` })),
        `${group} (${model.cases.filter(one => one.group === group).length})`);
      keys.append(key);
    }
    return keys;
  }

  highlight(index, className) {
    this.points.forEach((point, k) => point.classList.toggle(className, k === index));
    if (className !== "on") return;
    const one = model.cases[index];
    this.readout.textContent = one ? `${one.name}${one.group ? `, ${one.group}` : ""}: ` +
      this.axes.map(axis => `mode ${axis + 1} ${signed(one.modes[axis])}`).join(", ") : "";
  }
}

function signed(value) {
  return (value < 0 ? "−" : "+") + Math.abs(value).toFixed(2);
}
