// All cases in one canvas, under one camera. Each has a cell over the canvas, which is pointed at and clicked.

/// A name without what all names begin with, up to the end of a word.
const shortName = (() => {
  const names = model.cases.map(one => one.name);
  const [first, last] = [names.reduce((a, b) => (b < a ? b : a), names[0]), names.reduce((a, b) => (b > a ? b : a), names[0])];
  let same = 0;
  while (first && first !== last && first[same] === last[same]) ++same;
  while (same > 0 && /[\p{L}\p{N}]/u.test(first[same - 1])) --same;
  return name => name.slice(same);
})();

class Gallery {
  constructor(box, { pointed, chosen, turned }) {
    this.box = box;
    this.canvas = box.querySelector("canvas");
    this.cellsBox = box.querySelector(".cells");
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setScissorTest(true);
    this.camera = new THREE.OrthographicCamera();
    this.dotMaterials = { landmark: dotMaterial(4, false), mark: dotMaterial(9, true) };
    this.dotMaterials.landmark.uniforms.rim.value = 0;
    this.shapes = [];
    this.landmarks = true;
    this.vertex = -1;
    this.drawSoon = onceAFrame(() => this.draw());
    this.cells = model.cases.map((one, index) => this.makeCell(one, index, { pointed, chosen, turned }));
    this.cellsBox.append(...this.cells);
    box.addEventListener("scroll", this.drawSoon);
    new ResizeObserver(() => this.arrange()).observe(box);
    window.addEventListener("beforeprint", () => this.showWhole(true));
    window.addEventListener("afterprint", () => this.showWhole(false));
    this.arrange();
  }

  makeCell(one, index, { pointed, chosen, turned }) {
    const cell = document.createElement("button");
    cell.type = "button";
    cell.className = "cell";
    const name = document.createElement("span");
    name.textContent = shortName(one.name);
    cell.title = one.group ? `${one.name} (${one.group})` : one.name;
    cell.append(name);
    turnByPointer(cell, {
      turned,
      clicked: () => chosen(index),
      over: event => pointed(index, this.vertexAt(index, event)),
      left: () => pointed(-1, -1),
    });
    // The gallery is one stop of the Tab key; arrows lead from cell to cell.
    cell.tabIndex = index === 0 ? 0 : -1;
    cell.addEventListener("keydown", event => {
      if (event.key === "Enter" || event.key === " ") return event.preventDefault(), chosen(index);
      const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -this.columns, ArrowDown: this.columns }[event.key];
      const next = step && this.cells[index + step];
      if (next) event.preventDefault(), next.focus();
    });
    cell.addEventListener("focus", () => {
      this.cells.forEach(other => (other.tabIndex = other === cell ? 0 : -1));
      pointed(index, -1);
    });
    return cell;
  }

  shape(index) {
    if (!this.shapes[index]) {
      this.shapes[index] = new ShownShape(new Float32Array(model.shapeOfCase(index)), this.dotMaterials);
      this.paintShape(index);
    }
    return this.shapes[index];
  }

  /// `tintsOf`: the colours of a shape from its positions.
  paint(tintsOf) {
    this.tintsOf = tintsOf;
    this.shapes.forEach((shape, index) => shape && this.paintShape(index));
    this.drawSoon();
  }

  paintShape(index) {
    if (this.tintsOf) this.shapes[index].paint(this.tintsOf(this.shapes[index].positions));
  }

  /// Cells as large as all find room in the gallery, within limits; where there are many, it scrolls.
  arrange() {
    const width = this.box.clientWidth - 2, most = 520;
    const height = columns => Math.round(1.06 * width / columns) + 18;
    const fit = Math.max(3, Math.floor(width / 98));
    this.columns = Math.min(3, fit);
    while (this.columns < fit && Math.ceil(this.cells.length / this.columns) * height(this.columns) > most) ++this.columns;
    this.cellsBox.style.gridTemplateColumns = `repeat(${this.columns}, minmax(0, 1fr))`;
    this.cellsBox.style.gridAutoRows = `${height(this.columns)}px`;
    this.dotSize = Math.min(Math.max(width / this.columns / 32, 3.5), 7);
    this.drawSoon();
  }

  /// On paper nothing scrolls.
  showWhole(whole) {
    this.box.classList.toggle("whole", whole);
    this.arrange();
    this.draw();
  }

  mark(vertex) {
    this.vertex = vertex;
    this.drawSoon();
  }

  /// Where a cell's shape is drawn, CSS pixels from the upper left of what is seen of the gallery.
  room(index) {
    const cell = this.cells[index];
    return { left: cell.offsetLeft, top: cell.offsetTop - this.box.scrollTop, width: cell.offsetWidth, height: cell.offsetHeight - 18 };
  }

  draw() {
    const width = this.box.clientWidth, height = Math.min(this.box.clientHeight, this.cellsBox.offsetHeight);
    if (width === 0 || this.cells.length === 0) return;
    const all = this.cellsBox.offsetHeight, shown = Math.max(height, 1);
    const ratio = Math.min(window.devicePixelRatio || 1, 2, 8000 / shown);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, shown, false);
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${shown}px`;
    this.canvas.style.marginBottom = `${all - shown}px`;
    this.dotMaterials.landmark.uniforms.size.value = this.dotSize * ratio;
    this.dotMaterials.mark.uniforms.size.value = 9 * ratio;
    this.renderer.setScissor(0, 0, width, shown);
    this.renderer.clear();
    this.cells.forEach((cell, index) => {
      const room = this.room(index);
      if (room.top + room.height < 0 || room.top > shown) return;
      const shape = this.shape(index);
      shape.dots.visible = this.landmarks;
      shape.markVertex(this.vertex);
      const bottom = shown - room.top - room.height;
      this.renderer.setViewport(room.left, bottom, room.width, room.height);
      this.renderer.setScissor(room.left, bottom, room.width, room.height);
      aimCamera(this.camera, 1.05 * shownRadius.mm, room.width, room.height);
      this.renderer.render(shape.scene, this.camera);
    });
  }

  vertexAt(index, event) {
    const room = this.room(index), box = this.box.getBoundingClientRect();
    aimCamera(this.camera, 1.05 * shownRadius.mm, room.width, room.height);
    return vertexBelow(this.shape(index), this.camera, 2 * (event.clientX - box.left - room.left) / room.width - 1,
      1 - 2 * (event.clientY - box.top - room.top) / room.height);
  }

  highlight(index, className) {
    this.cells.forEach((cell, k) => cell.classList.toggle(className, k === index));
  }

  bringIntoView(index) {
    const cell = this.cells[index], box = this.box;
    if (cell.offsetTop < box.scrollTop) box.scrollTop = cell.offsetTop;
    if (cell.offsetTop + cell.offsetHeight > box.scrollTop + box.clientHeight)
      box.scrollTop = cell.offsetTop + cell.offsetHeight - box.clientHeight;
  }
}
