// The state of the page, how it is drawn, and what is told of it.

const STEP = Math.PI / 36; // an arrow key turns by 5 degrees
const TURN = 2 * Math.PI; // a drag across the picture turns once around
const NAMES = ["00", "1−1", "10", "11", "2−2", "2−1", "20", "21", "22"];
const SOURCES = { normals: 0, transfer: 1, reference: 1 };
const WAYS = { picture: 0, signed: 1, difference: 2, normals: 3, albedo: 4, colours: 5 };
const SAMPLES = 4000; // vertices that the exposure is fitted to
const THUMBNAIL = 80; // pixels
const REST = 200; // milliseconds without a turn after which thumbnails are drawn anew
const SLOW = 70; // milliseconds between frames from which on pixels are given up
const COARSEST = 4; // screen pixels to a side of a drawn one, then
const BRIGHTEST = 0.95; // where fitting puts the brightest half percent of them
const EDITED = -1; // among the lights: one that a slider has moved
const GROUND = [0.72, 0.72, 0.72];

const scene = JSON.parse(document.getElementById("scene").textContent);
const element = (id) => document.getElementById(id);

const state = {
  coefficients: null, // channels x K, of the light before it was turned by `light`
  chosen: 0, // which of the lights it came from
  edited: false, // whether a slider has moved it since
  object: IDENTITY,
  light: IDENTITY, // rotation since `coefficients` were set
  mapRotation: IDENTITY, // rotation since the light was chosen
  zoom: 1,
  exposure: 1,
};
let renderer;
let transfer = null;
let reference = null;
const thumbnailExposures = []; // of each harmonic alone, fitted once
let soon = 0; // the timer that runs while things turn
let lastFrame = 0; // when it was drawn, while things turn
let coarseness = 1; // screen pixels to a side of a drawn one
let turningCoarseness = 1; // what it is while things turn
let drawn = 0; // number of the frame that is asked for, 0 if none is

/** Return the light in the frame of the picture, turned as it is. */
function turnedLight() {
  return rotated(state.coefficients, state.light, scene.quadrature);
}

/** Return radiosity over albedo of every vertex by its transfer vector. */
function transferred(object, light) {
  // The vectors were made for the object at rest: the light is turned back with it.
  const local = rotated(state.coefficients, product(transposed(object), light), scene.quadrature);
  return byTransfer(local);
}

function byTransfer(light) {
  const { values, scales, channels } = transfer;
  const count = scales.length;
  const scaled = light.map((own) => Float64Array.from(own.slice(0, count), (v, k) => v * scales[k]));
  const found = new Float32Array(3 * renderer.count);
  for (let i = 0; i < found.length; i += 1) {
    const channel = i % 3;
    const first = count * (channels === 3 ? i : (i - channel) / 3);
    const own = scaled[channel];
    let sum = 0;
    for (let k = 0; k < count; k += 1) sum += own[k] * values[first + k];
    found[i] = sum;
  }
  return found;
}

/** Return whether brute force is shown, which holds for one light and moves with the object. */
function bound() {
  return element("sources").value === "reference" || element("ways").value === "difference";
}

/** Return what the renderer needs to draw the present state. */
function currentView() {
  const way = element("ways").value;
  const mapped = scene.lights[state.chosen].mapped && !state.edited;
  return {
    object: state.object,
    light: state.light,
    mapRotation: state.mapRotation,
    matrices: state.coefficients.map((own) => irradianceMatrix(own, scene.matrices)),
    source: SOURCES[element("sources").value],
    shown: way in WAYS ? WAYS[way] : WAYS.colours,
    painted: element("painted").checked,
    coarse: coarseness > 1,
    exposure: state.exposure,
    zoom: state.zoom,
    ground: GROUND,
    background: mapped && element("background").checked,
    mirror: mapped && element("mirror").checked,
  };
}

/** Give the vertices what the present view needs of them. */
function carry() {
  const way = element("ways").value;
  if (way in scene.colours) {
    renderer.carry(Float32Array.from(unpacked(scene.colours[way], Uint8Array), (v) => v / 255));
  } else if (bound()) {
    renderer.carry(reference);
  } else if (element("sources").value === "transfer") {
    renderer.carry(transferred(state.object, state.light));
  }
}

function draw() {
  drawn = 0;
  keepUp();
  carry();
  const view = currentView();
  renderer.draw(view);
  const isSigned = view.shown === WAYS.signed || view.shown === WAYS.difference;
  element("scale").hidden = !isSigned;
  element("scale").textContent = `Colours end at ±${(1 / view.exposure).toPrecision(3)}, in the unit of irradiance.`;
}

/** Draw before the browser shows the page next, once however often it is asked. */
function redraw() {
  if (!drawn) drawn = requestAnimationFrame(draw);
}

/** Draw what every harmonic alone does to the object as it is turned, when it comes to rest. */
function drawThumbnailsSoon() {
  clearTimeout(soon);
  soon = setTimeout(() => {
    soon = 0;
    lastFrame = 0;
    coarseness = 1;
    setCanvasSize();
    drawThumbnails();
  }, REST);
}

/** While things turn, give up pixels and triangles where the machine cannot draw all in time. */
function keepUp() {
  const now = performance.now();
  if (soon) {
    if (lastFrame && now - lastFrame > SLOW) turningCoarseness = COARSEST;
    coarseness = turningCoarseness;
    setCanvasSize();
  }
  lastFrame = soon ? now : 0;
}

function drawThumbnails() {
  const kept = state.coefficients;
  const asTransfer = element("sources").value === "transfer";
  const { canvas } = renderer;
  // All are drawn side by side and then copied: the canvas is read once.
  NAMES.forEach((_, k) => {
    state.coefficients = alone(k);
    if (asTransfer) renderer.carry(transferred(state.object, IDENTITY));
    const view = {
      ...currentView(), light: IDENTITY, shown: WAYS.signed, background: false, mirror: false,
      source: asTransfer ? 1 : 0, coarse: true,
    };
    thumbnailExposures[k] ??= fittedExposure(view);
    view.exposure = thumbnailExposures[k];
    renderer.draw(view, THUMBNAIL, THUMBNAIL, ...cell(k));
  });
  NAMES.forEach((_, k) => {
    const [left, bottom] = cell(k);
    element(`basis${k}`).getContext("2d").drawImage(
      canvas, left, canvas.height - bottom - THUMBNAIL, THUMBNAIL, THUMBNAIL,
      0, 0, THUMBNAIL, THUMBNAIL,
    );
  });
  state.coefficients = kept;
  draw();
}

/** Return where a thumbnail is drawn before it is copied, three to a row. */
function cell(k) {
  return [THUMBNAIL * (k % 3), THUMBNAIL * Math.floor(k / 3)];
}

function alone(k) {
  const count = state.coefficients[0].length;
  return [0, 1, 2].map(() => Array.from({ length: count }, (_, j) => (j === k ? 1 : 0)));
}

/** Return the exposure at which the brightest half percent of what faces the viewer is white. */
function fittedExposure(view) {
  const step = Math.max(1, Math.floor(renderer.count / SAMPLES));
  let carried = null;
  if (view.source === 1) carried = bound() ? reference : transferred(view.object, view.light);
  // Normals are turned with the object, and then back with the light.
  const towardsLight = product(transposed(view.light), view.object);
  const along = (row, i) => (row[0] * renderer.normals[3 * i] + row[1] * renderer.normals[3 * i + 1]
    + row[2] * renderer.normals[3 * i + 2]) / 32767;
  const isDifference = view.shown === WAYS.difference;
  const sizes = [];
  for (let i = 0; i < renderer.count; i += step) {
    if (along(view.object[2], i) > 0) {
      const n = towardsLight.map((row) => along(row, i));
      let value = 0;
      for (let channel = 0; channel < 3; channel += 1) {
        const paint = view.painted ? renderer.albedo[3 * i + channel] / 65535 : 1;
        let received = carried ? carried[3 * i + channel] : irradiance(view.matrices[channel], n);
        if (isDifference) received = irradiance(view.matrices[channel], n) - reference[3 * i + channel];
        value += scene.luminance[channel] * paint * received;
      }
      sizes.push(isDifference || view.shown === WAYS.signed ? Math.abs(value) : value);
    }
  }
  sizes.sort((a, b) => a - b);
  const bright = sizes[Math.floor(0.995 * (sizes.length - 1))];
  return bright > 0 ? BRIGHTEST / bright : 1;
}

function fit() {
  state.exposure = fittedExposure(currentView());
  element("exposure").value = Math.log2(state.exposure);
}

function setLight(coefficients) {
  state.coefficients = coefficients;
  state.light = IDENTITY;
}

function choose(index) {
  setLight(scene.lights[index].coefficients.map((own) => [...own]));
  state.chosen = index;
  state.edited = false;
  state.mapRotation = IDENTITY;
  widenSliders();
  fit();
  told();
}

/** Let sliders reach twice as far as the largest coefficient. */
function widenSliders() {
  const largest = Math.max(...state.coefficients.flatMap((own) => own.slice(0, 9).map(Math.abs)));
  NAMES.forEach((_, k) => {
    element(`slider${k}`).min = -2 * largest || -1;
    element(`slider${k}`).max = 2 * largest || 1;
  });
}

/** Return what a slider shows of the light: one channel, or the mean of them. */
function shownValue(light, k) {
  const channel = element("channel").value;
  if (channel === "all") return light.reduce((sum, own) => sum + own[k], 0) / light.length;
  return light[channel][k];
}

/** Move a coefficient of the light as it stands; with all channels their differences stay. */
function moveCoefficient(k, value) {
  const light = turnedLight();
  const change = value - shownValue(light, k);
  const channel = element("channel").value;
  light.forEach((own, i) => {
    if (channel === "all" || Number(channel) === i) own[k] += change;
  });
  setLight(light);
  state.edited = true;
}

/** Return a number's text, zero without a sign. */
function fixed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text;
}

/** Show the light's numbers on the sliders and in the readout, and the picture. */
function told() {
  const light = turnedLight();
  NAMES.forEach((_, k) => {
    const value = shownValue(light, k);
    element(`slider${k}`).value = value;
    element(`value${k}`).textContent = fixed(value, 3);
    const others = light.some((own) => own.some((other, j) => j !== k && Math.abs(other) > 1e-12));
    element(`basis${k}`).parentNode.setAttribute("aria-pressed", String(!others && value !== 0));
  });
  const mapped = scene.lights[state.chosen].mapped && !state.edited;
  document.querySelectorAll(".mapped").forEach((label) => { label.hidden = !mapped; });
  element("lights").value = state.edited ? EDITED : state.chosen;
  const column = (value) => fixed(value, 4).padStart(9);
  element("readout").textContent = [
    "          red    green     blue",
    ...NAMES.map((name, k) => `L${name.padEnd(3)}${light.map((own) => column(own[k])).join("")}`),
  ].join("\n");
  redraw();
}

function lightAsJson() {
  return JSON.stringify({
    coefficients: turnedLight(), object_rotation: state.object, exposure: state.exposure,
  });
}

function lightAsGlsl() {
  const matrices = turnedLight().map((own) => irradianceMatrix(own, scene.matrices));
  const number = (value) => (Number.isInteger(value) ? value.toFixed(1) : value.toPrecision(9));
  return [
    "// E(n) = dot(n4, M * n4) with n4 = vec4(n, 1), RH01 eq. 11-12; M is symmetric.",
    "// The unit normal n has x to the right, y up and z towards the viewer.",
    ...["Mr", "Mg", "Mb"].map(
      (name, i) => `const mat4 ${name} = mat4(${matrices[i].map(number).join(", ")});`,
    ),
    "vec3 irradiance(vec3 n) {",
    "    vec4 n4 = vec4(n, 1.0);",
    "    return vec3(dot(n4, Mr * n4), dot(n4, Mg * n4), dot(n4, Mb * n4));",
    "}",
    "",
  ].join("\n");
}

/** Copy text; pages without the right to the clipboard select it in the readout instead. */
async function copy(text, button) {
  const said = button.textContent;
  element("readout").textContent = text;
  getSelection().selectAllChildren(element("readout"));
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = "copied";
  } catch {
    button.textContent = document.execCommand("copy") ? "copied" : "press Ctrl+C";
  }
  setTimeout(() => { button.textContent = said; }, 1500);
}

/** Turn the object or the light; brute force holds for both as they were, so both turn. */
function turn(rotation, isLight) {
  const both = bound();
  if ((!isLight || both) && !scene.flat) state.object = orthonormal(product(rotation, state.object));
  if (isLight || both || scene.flat) {
    state.light = orthonormal(product(rotation, state.light));
    state.mapRotation = orthonormal(product(rotation, state.mapRotation));
  }
  drawThumbnailsSoon();
  told();
}

function reset() {
  state.object = IDENTITY;
  state.zoom = 1;
  choose(state.chosen);
  drawThumbnails();
}

function zoomBy(factor) {
  state.zoom = Math.min(50, Math.max(0.2, state.zoom * factor));
  redraw();
}

/** Brute force was baked for one light and the object at rest: go there. */
function bind() {
  if (!bound()) return;
  state.object = IDENTITY;
  choose(scene.lights.findIndex((light) => light.reference));
}
