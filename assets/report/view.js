// What is drawn in 3D: surfaces, landmarks and arrows, and how they are looked at. The light is the program's own.

/// Where all shapes are looked at from: degrees around the body's axis (0: from the front) and above the horizon.
const turn = { around: 0, above: 0, zoom: 1 };

function lookDirection() {
  const a = turn.around * Math.PI / 180, e = turn.above * Math.PI / 180;
  return {
    toEye: new THREE.Vector3(Math.sin(a) * Math.cos(e), -Math.cos(a) * Math.cos(e), Math.sin(e)),
    up: new THREE.Vector3(-Math.sin(a) * Math.sin(e), Math.cos(a) * Math.sin(e), Math.cos(e)),
    right: new THREE.Vector3(Math.cos(a), Math.sin(a), 0),
  };
}

const surfaceMaterial = new THREE.ShaderMaterial({
  side: THREE.DoubleSide,
  uniforms: { opacity: { value: 1 } },
  vertexShader: `
    attribute vec3 tint;
    varying vec3 shownTint, normalEye;
    void main() {
      shownTint = tint;
      normalEye = normalMatrix * normal;
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    }`,
  fragmentShader: `
    varying vec3 shownTint, normalEye;
    uniform float opacity;
    ${model.light}
    void main() {
      vec3 normal = normalEye * inversesqrt(max(dot(normalEye, normalEye), 1e-12));
      vec3 side = gl_FrontFacing ? shownTint : mix(shownTint, vec3(0.45), 0.5) * 0.75;
      gl_FragColor = vec4(lit(side, gl_FrontFacing ? normal : -normal, vec3(0.0, 0.0, 1.0), 0.14), opacity);
    }`,
});

/// Arrows that lead inwards are seen through it.
const glassMaterial = surfaceMaterial.clone();
glassMaterial.side = THREE.FrontSide;
glassMaterial.transparent = true;
glassMaterial.uniforms.opacity.value = 0.62;

/// Round dots of a size in pixels. They are drawn a little nearer to the eye, so that no dot sinks into the surface.
function dotMaterial(size, alwaysSeen) {
  return new THREE.ShaderMaterial({
    depthTest: !alwaysSeen,
    transparent: alwaysSeen,
    uniforms: { size: { value: size }, nearer: { value: 0.02 }, rim: { value: 0.28 } },
    vertexShader: `
      attribute vec3 tint;
      uniform float size, nearer;
      varying vec3 shownTint;
      void main() {
        shownTint = tint;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        gl_Position.z -= nearer;
        gl_PointSize = size;
      }`,
    fragmentShader: `
      varying vec3 shownTint;
      uniform float rim;
      void main() {
        float r = 2.0 * length(gl_PointCoord - 0.5);
        if (r > 1.0) discard;
        gl_FragColor = vec4(r > 1.0 - rim ? vec3(0.08) : shownTint, 1.0);
      }`,
  });
}

const faceIndex = new THREE.BufferAttribute(model.faces, 1);

/// A shape on the screen: its surface, its landmarks, and the mark of the vertex that is pointed at.
class ShownShape {
  constructor(positions, dotMaterials) {
    this.positions = positions;
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setIndex(faceIndex);
    this.geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    this.geometry.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(positions.length), 3));
    this.geometry.setAttribute("tint", new THREE.BufferAttribute(new Float32Array(positions.length), 3));
    this.surface = new THREE.Mesh(this.geometry, surfaceMaterial);
    this.dots = dots(model.glyphs.length, dotMaterials.landmark);
    model.glyphs.forEach((v, k) => this.dots.geometry.attributes.tint.setXYZ(k, ...hueColour(model.hues[v], 1)));
    this.mark = dots(1, dotMaterials.mark);
    this.mark.geometry.attributes.tint.setXYZ(0, 1, 1, 1);
    this.mark.visible = false;
    this.scene = new THREE.Scene();
    this.scene.add(this.surface, this.dots, this.mark);
    this.moved();
  }

  /// After the positions were changed.
  moved() {
    const { position, normal } = this.geometry.attributes;
    position.needsUpdate = true;
    this.geometry.computeVertexNormals();
    normal.needsUpdate = true;
    this.geometry.computeBoundingSphere();
    model.glyphs.forEach((v, k) => placeDot(this.dots, k, this.positions, v));
  }

  paint(tints) {
    this.geometry.attributes.tint.copyArray(tints);
    this.geometry.attributes.tint.needsUpdate = true;
  }

  /// −1: none.
  markVertex(vertex) {
    this.mark.visible = vertex >= 0;
    if (vertex >= 0) placeDot(this.mark, 0, this.positions, vertex);
  }

  middle() {
    return this.geometry.boundingSphere.center;
  }
}

function dots(count, material) {
  const geometry = new THREE.BufferGeometry();
  for (const name of ["position", "tint"])
    geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * count), 3));
  const points = new THREE.Points(geometry, material);
  points.frustumCulled = false;
  return points;
}

function placeDot(points, k, positions, vertex) {
  points.geometry.attributes.position.setXYZ(k, positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]);
  points.geometry.attributes.position.needsUpdate = true;
}

/// The radius of a ball that holds the mean and all that its modes make of it at ±3, mm.
const shownRadius = (() => {
  let most = 0;
  const centre = [0, 1, 2].map(c => {
    let sum = 0;
    for (let i = c; i < model.mean.length; i += 3) sum += model.mean[i];
    return sum / model.vertices;
  });
  for (let v = 0; v < model.vertices; ++v)
    most = Math.max(most, Math.hypot(...[0, 1, 2].map(c => model.mean[3 * v + c] - centre[c])));
  return { centre: new THREE.Vector3(...centre), mm: 1.15 * most };
})();

/// An orthographic camera, so that lengths compare: it shows a ball of this radius.
function aimCamera(camera, radius, width, height) {
  const { toEye, up } = lookDirection();
  const shorter = Math.min(width, height) / 2;
  camera.left = -radius * width / 2 / shorter;
  camera.right = -camera.left;
  camera.top = radius * height / 2 / shorter;
  camera.bottom = -camera.top;
  camera.near = 0;
  camera.far = 8 * shownRadius.mm;
  camera.up.copy(up);
  camera.position.copy(shownRadius.centre).addScaledVector(toEye, 4 * shownRadius.mm);
  camera.lookAt(shownRadius.centre);
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
  return radius / shorter;  // mm of a CSS pixel
}

const rays = new THREE.Raycaster();

/// The vertex of a shape below a place (−1…1 to the right and up); −1: none.
function vertexBelow(shape, camera, x, y) {
  rays.setFromCamera(new THREE.Vector2(x, y), camera);
  shape.surface.updateMatrixWorld();
  const hit = rays.intersectObject(shape.surface)[0];
  if (!hit) return -1;
  const distance = v => hit.point.distanceToSquared(new THREE.Vector3().fromArray(shape.positions, 3 * v));
  return [hit.face.a, hit.face.b, hit.face.c].reduce((best, v) => (distance(v) < distance(best) ? v : best));
}

/// Arrows as one surface: each leads from where a vertex of a shape lies to where `scale` times the mode brings it.
function arrowGeometry(shape, mode, scale, tint) {
  const outline = [[0, 0], [0.5, 0], [0.5, 0.66], [1.25, 0.66], [0, 1]].map(([x, y]) => new THREE.Vector2(x, y));
  const one = new THREE.LatheBufferGeometry(outline, 10);
  const count = one.attributes.position.count, indices = [], positions = [], normals = [], tints = [];
  const up = new THREE.Vector3(0, 1, 0), turned = new THREE.Quaternion(), point = new THREE.Vector3();
  const thick = 0.011 * shownRadius.mm;
  for (const v of model.arrows) {
    const from = new THREE.Vector3().fromArray(shape, 3 * v);
    const by = new THREE.Vector3().fromArray(model.modeShapes, mode * model.mean.length + 3 * v).multiplyScalar(scale);
    const length = by.length();
    if (length < 0.01 * shownRadius.mm) continue;
    turned.setFromUnitVectors(up, by.clone().divideScalar(length));
    const width = Math.min(thick, length / 4), first = positions.length / 3;
    for (let k = 0; k < count; ++k) {
      point.fromBufferAttribute(one.attributes.position, k);
      point.set(point.x * width, point.y * length, point.z * width).applyQuaternion(turned).add(from);
      positions.push(point.x, point.y, point.z);
      point.fromBufferAttribute(one.attributes.normal, k).applyQuaternion(turned);
      normals.push(point.x, point.y, point.z);
      tints.push(...tint);
    }
    for (const index of one.index.array) indices.push(first + index);
  }
  const all = new THREE.BufferGeometry();
  all.setIndex(indices);
  all.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  all.setAttribute("normal", new THREE.Float32BufferAttribute(normals, 3));
  all.setAttribute("tint", new THREE.Float32BufferAttribute(tints, 3));
  return all;
}

/// Turns by a drag; calls `clicked` where the pointer did not move. `over` is called while it only points.
function turnByPointer(element, { turned, clicked, over, left }) {
  let last = null, moved = 0;
  element.addEventListener("pointerdown", event => {
    if (event.button !== 0) return;
    last = event;
    moved = 0;
    element.setPointerCapture(event.pointerId);
  });
  element.addEventListener("pointermove", event => {
    if (!last) return over(event);
    const right = event.clientX - last.clientX, down = event.clientY - last.clientY;
    moved += Math.abs(right) + Math.abs(down);
    last = event;
    if (moved > 3) turnBy(-0.5 * right, 0.5 * down), turned();
  });
  element.addEventListener("pointerup", event => {
    if (last && moved <= 3) clicked(event);
    last = null;
  });
  element.addEventListener("pointercancel", () => (last = null));
  element.addEventListener("pointerleave", left);
}

function turnBy(around, above) {
  turn.around = (turn.around + around + 540) % 360 - 180;
  turn.above = Math.min(Math.max(turn.above + above, -90), 90);
}

function zoomBy(factor) {
  turn.zoom = Math.min(Math.max(turn.zoom * factor, 0.4), 8);
}

/// The letters of where a direction leads in the body: "L", or "LS" between two.
function sideLetters(direction) {
  const sides = [["L", "R", direction.x], ["P", "A", direction.y], ["S", "I", direction.z]];
  return sides.filter(([, , share]) => Math.abs(share) > 0.38).sort((a, b) => Math.abs(b[2]) - Math.abs(a[2]))
    .map(([plus, minus, share]) => (share > 0 ? plus : minus)).join("");
}

/// The view of one shape.
class ShapeView {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.camera = new THREE.OrthographicCamera();
    this.dotMaterials = { landmark: dotMaterial(9, false), mark: dotMaterial(13, true) };
    this.shape = new ShownShape(new Float32Array(model.mean), this.dotMaterials);
    this.arrows = null;
    this.drawSoon = onceAFrame(() => this.draw());
    new ResizeObserver(() => this.drawSoon()).observe(canvas);
  }

  showArrows(geometry) {
    if (this.arrows) this.shape.scene.remove(this.arrows), this.arrows.geometry.dispose();
    this.arrows = geometry ? new THREE.Mesh(geometry, surfaceMaterial) : null;
    this.shape.surface.material = geometry ? glassMaterial : surfaceMaterial;
    if (this.arrows) this.shape.scene.add(this.arrows);
  }

  draw() {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (width === 0 || height === 0) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.dotMaterials.landmark.uniforms.size.value = 9 * ratio;
    this.dotMaterials.mark.uniforms.size.value = 13 * ratio;
    this.mmPerPixel = aimCamera(this.camera, shownRadius.mm / turn.zoom, width, height);
    this.renderer.render(this.shape.scene, this.camera);
    if (this.drawn) this.drawn();
  }

  vertexAt(event) {
    const box = this.canvas.getBoundingClientRect();
    return vertexBelow(this.shape, this.camera, 2 * (event.clientX - box.left) / box.width - 1,
      1 - 2 * (event.clientY - box.top) / box.height);
  }
}

/// A function that is called once before the next frame, however often it is asked for.
function onceAFrame(work) {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      work();
    });
  };
}
