// What the hands do: pointers, keys, sliders and choices; and the start of the page.

function listenToPointer(canvas) {
  const held = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    held.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!held.has(event.pointerId)) return;
    const [x, y] = held.get(event.pointerId);
    const others = [...held].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
    held.set(event.pointerId, [event.clientX, event.clientY]);
    const [dx, dy] = [event.clientX - x, event.clientY - y];
    const size = Math.min(canvas.clientWidth, canvas.clientHeight) * held.size;
    const isLight = event.shiftKey || held.size > 1 || element("turnsLight").checked;
    turn(
      product(rotationAbout(0, (TURN * dy) / size), rotationAbout(1, (TURN * dx) / size)), isLight,
    );
    if (others.length === 1) {
      const [[ox, oy]] = others;
      const before = Math.hypot(x - ox, y - oy);
      if (before > 0) zoomBy(Math.hypot(event.clientX - ox, event.clientY - oy) / before);
    }
  });
  ["pointerup", "pointercancel"].forEach((name) => {
    canvas.addEventListener(name, (event) => held.delete(event.pointerId));
  });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoomBy(Math.exp(-event.deltaY / 500));
  }, { passive: false });
}

function listenToKeys(canvas) {
  const turns = { ArrowLeft: [1, -STEP], ArrowRight: [1, STEP], ArrowUp: [0, -STEP], ArrowDown: [0, STEP] };
  canvas.addEventListener("keydown", (event) => {
    if (event.key in turns) {
      turn(rotationAbout(...turns[event.key]), event.shiftKey || element("turnsLight").checked);
    } else if (event.key === "+" || event.key === "=") zoomBy(1.1);
    else if (event.key === "-") zoomBy(1 / 1.1);
    else if (event.key === "Home") reset();
    else return;
    event.preventDefault();
  });
}

function listenToChoices() {
  element("lights").addEventListener("change", (event) => choose(Number(event.target.value)));
  ["sources", "ways"].forEach((id) => element(id).addEventListener("change", () => {
    bind();
    fit();
    if (id === "sources") {
      thumbnailExposures.length = 0;
      drawThumbnailsSoon();
    }
    redraw();
  }));
  ["background", "mirror"].forEach((id) => element(id).addEventListener("change", redraw));
  element("painted").addEventListener("change", () => { redraw(); drawThumbnailsSoon(); });
  element("channel").addEventListener("change", told);
  element("exposure").addEventListener("input", (event) => {
    state.exposure = 2 ** event.target.value;
    redraw();
  });
  element("fit").addEventListener("click", () => { fit(); redraw(); });
  element("copyJson").addEventListener("click", (event) => copy(lightAsJson(), event.target));
  element("copyGlsl").addEventListener("click", (event) => copy(lightAsGlsl(), event.target));
}

function addOption(select, value, text) {
  const option = document.createElement("option");
  option.value = value;
  option.textContent = text;
  select.append(option);
  return option;
}

function fillChoices() {
  addOption(element("lights"), EDITED, "as edited below").hidden = true;
  scene.lights.forEach(({ name }, index) => addOption(element("lights"), index, name));
  const sources = element("sources");
  if (transfer) addOption(sources, "transfer", "transfer vectors: shadows and bounces");
  if (!scene.flat) addOption(sources, "normals", "E = nᵀ M n, nine coefficients");
  if (reference) addOption(sources, "reference", "brute force, cast shadows included");
  const ways = element("ways");
  addOption(ways, "picture", "picture");
  addOption(ways, "signed", "green above zero, blue below");
  if (reference) addOption(ways, "difference", "nine coefficients less brute force");
  if (!scene.flat) {
    addOption(ways, "normals", "normals (n + 1) / 2");
    addOption(ways, "albedo", "albedo");
  }
  Object.keys(scene.colours).forEach((name) => addOption(ways, name, name));
}

function addSliders() {
  NAMES.forEach((name, k) => {
    const row = document.createElement("li");
    row.innerHTML = `<button type="button" aria-label="harmonic ${name} alone">`
      + `<canvas id="basis${k}" width="${THUMBNAIL}" height="${THUMBNAIL}"></canvas></button>`
      + `<label for="slider${k}">L<sub>${name}</sub></label>`
      + `<input id="slider${k}" type="range" step="any"><output id="value${k}"></output>`;
    row.querySelector("button").addEventListener("click", () => {
      setLight(alone(k));
      state.edited = true;
      element("ways").value = "signed";
      widenSliders();
      fit();
      told();
    });
    row.querySelector("input").addEventListener("input", (event) => {
      moveCoefficient(k, Number(event.target.value));
      told();
    });
    element("sliders").append(row);
  });
}

/** Make the canvas as fine as the screen, or coarser while it has to keep up. */
function setCanvasSize() {
  const { canvas } = renderer;
  const fine = (window.devicePixelRatio || 1) / coarseness;
  const width = Math.max(3 * THUMBNAIL, Math.round(canvas.clientWidth * fine));
  const height = Math.max(3 * THUMBNAIL, Math.round(canvas.clientHeight * fine));
  // Even the same size would clear it.
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
}

/** Draw in the new size, and take note if that takes long. */
function resize() {
  setCanvasSize();
  const start = performance.now();
  draw();
  renderer.finish();
  if (performance.now() - start > SLOW) turningCoarseness = COARSEST;
  drawThumbnails();
}

function start() {
  const canvas = element("view");
  renderer = new Renderer(canvas, scene.shaders, scene);
  if (scene.transfer) {
    transfer = { ...scene.transfer, values: unpacked(scene.transfer.values, Int16Array) };
  }
  if (scene.reference) reference = unpacked(scene.reference, Float32Array);
  fillChoices();
  addSliders();
  choose(0);
  listenToPointer(canvas);
  listenToKeys(canvas);
  listenToChoices();
  new ResizeObserver(resize).observe(canvas);
}

try {
  start();
} catch (error) {
  element("failure").textContent = String(error.message);
  element("failure").hidden = false;
  throw error;
}
