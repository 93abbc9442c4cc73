// The framed 3-D view: captions over the figures, cameras, dark and light.
// viser publishes its internals as `__viserMutable` for tests; where they are missing the view
// still works, without captions and cameras.

import { $, $$, press } from "./ui.js";

// Direction from which a camera looks, its distance (m), and at what; in viser's world, z up.
const CAMERAS = {
  front: { from: [3.05, -1.15, 0.95], at: [0, -0.03, 0.4] },
  side: { from: [1.1, -3.6, 0.8], at: [0, 0, 0.4] },
  behind: { from: [-3.2, -0.5, 1.3], at: [0, 0, 0.42] },
  top: { from: [0.6, 0, 3.9], at: [0, 0, 0] },
};
const WIDE = 1.75; // narrower views step back, so that all three figures stay in sight

const frame = $("#view");
const CAPTIONS = $$(".caption");
let onKeys = () => {};
let connected = false;

export const inside = () => frame.contentWindow?.__viserMutable ?? null;

export function startView({ keys, ready }) {
  onKeys = keys;
  frame.addEventListener("load", () => {
    const inner = frame.contentWindow;
    onKeys(inner);
    themeFrame();
    // The view's canvas takes files as well, and must not open them in its frame.
    for (const kind of ["dragenter", "dragover", "dragleave", "drop"])
      inner.addEventListener(kind, (event) => {
        event.preventDefault();
        document.dispatchEvent(new CustomEvent("frame-drag", { detail: { kind, transfer: event.dataTransfer } }));
      });
  });
  frame.src = "/view/";
  for (const button of $$(".cameras button"))
    button.addEventListener("click", () => look(button.dataset.camera));
  let shown = false;
  const each = () => {
    connected = placeCaptions();
    if (connected && !shown) { shown = true; look(camera, false); spare(); ready(); }
    requestAnimationFrame(each);
  };
  requestAnimationFrame(each);
}

export function reloadView() {
  if (!frame.contentWindow?.__viserMutable || !connected) frame.src = "/view/";
}

export function themeFrame() {
  const theme = document.documentElement.dataset.theme;
  const root = frame.contentDocument?.documentElement;
  if (root) root.dataset.theme = theme;
}

// viser's world is z up, three.js' is y up: (x, y, z) is drawn at (x', y', z') = turn(x, y, z).
function toThree(m, point) {
  const root = m.nodeRefFromName[""];
  const V = m.camera.position.constructor;
  const v = new V(...point);
  return root ? root.localToWorld(v) : v;
}

// Without a graphics card every pixel is work for the processor, which the robot needs: draw
// half as fine, without shadows.
function spare() {
  const m = inside(), context = m.canvas.getContext("webgl2");
  const named = context?.getExtension("WEBGL_debug_renderer_info");
  const renderer = named ? context.getParameter(named.UNMASKED_RENDERER_WEBGL) : "";
  if (!/swiftshader|llvmpipe|software|basic render/i.test(renderer)) return;
  frame.contentWindow.__viserTestpoints?.devSettings.set({ fixedDpr: 0.5 * devicePixelRatio });
  m.scene.traverse((thing) => { if (thing.isLight) thing.castShadow = false; });
}

let camera = "front";

export function look(name, glide = true) {
  const m = inside();
  if (!m?.cameraControl) return;
  camera = name;
  const { from, at } = CAMERAS[name];
  const back = Math.max(1, WIDE / (frame.clientWidth / frame.clientHeight));
  const eye = toThree(m, at.map((c, i) => c + back * from[i])), to = toThree(m, at);
  m.cameraControl.setLookAt(eye.x, eye.y, eye.z, to.x, to.y, to.z, glide);
  m.requestRender();
  press($(".cameras"), "camera", name);
}

// Runs every frame: reads no layout it has just changed, and writes only what moved.
const sizes = new Map();
new ResizeObserver(() => { sizes.clear(); if (connected) look(camera, false); }).observe(frame);

function placeCaptions() {
  const m = inside();
  if (!m?.camera || !m.nodeRefFromName) return false;
  let found = 0;
  for (const node of CAPTIONS) {
    const anchor = m.nodeRefFromName[`/captions/${node.dataset.figure}`];
    if (!anchor) continue;
    found += 1;
    if (!sizes.has(frame)) sizes.set(frame, [frame.clientWidth, frame.clientHeight]);
    if (!sizes.has(node)) sizes.set(node, [node.offsetWidth, node.offsetHeight]);
    const [w, h] = sizes.get(frame), [width, height] = sizes.get(node);
    const p = anchor.getWorldPosition(anchor.position.clone()).project(m.camera);
    const half = width / 2 + 6;
    const left = Math.min(w - half, Math.max(half, ((p.x + 1) / 2) * w));
    const top = Math.min(h - 70, Math.max(height + 6, ((1 - p.y) / 2) * h));
    const inFront = Math.abs(p.x) < 1.1 && Math.abs(p.y) < 1.2;
    const style = inFront ? `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px) translate(-50%, -100%)` : "";
    if (node.dataset.at === style) continue;
    node.dataset.at = style;
    node.style.transform = style;
    node.style.visibility = inFront ? "visible" : "hidden";
  }
  return found === 3;
}

export function captions(words) {
  for (const node of CAPTIONS) {
    const line = $("span", node), word = words[node.dataset.figure] ?? "";
    if (line.textContent !== word) { line.textContent = word; sizes.delete(node); }
  }
}
