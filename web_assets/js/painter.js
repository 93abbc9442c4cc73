// More than one picture on viser's canvas: the person's half of a split view, what an eye sees.

/** @import { Panes, Rect } from "./panes.js" */
/** @import { Camera3D, Renderer, Viser } from "../types/page.js" */

/**
 * Draws on a part of the canvas what a camera sees.
 *
 * @typedef {(camera: Camera3D, at: Rect) => void} Draw
 */

/** How far the person's camera is from them, of how far the robots' is from these. */
const NEARER = 0.9;
/** m: the height at which it looks at them. */
const PERSON = 0.67;

export class Painter {
  /** The person's camera in a split view, once it was used. @type {Camera3D | null} */
  person = null;
  /** @type {Viser["scene"] | null} */
  #scene = null;

  /** @param {Panes} panes */
  constructor(panes) {
    this.panes = panes;
  }

  /** Draw on this view from now on: viser calls a scene's own hooks. @param {Viser} viser */
  attach(viser) {
    const { scene } = viser;
    if (scene === this.#scene) return;
    this.#scene = scene;
    this.person = null;
    scene.onBeforeRender = (renderer, _, camera) => {
      if (camera === viser.camera) this.#before(viser, renderer);
    };
    scene.onAfterRender = (renderer, _, camera) => {
      if (camera === viser.camera) this.#after(viser, renderer);
    };
  }

  /** @param {Viser} viser @param {Renderer} renderer */
  #before(viser, renderer) {
    const { at } = this.panes.of(viser, "robot");
    shape(viser.camera, at);
    if (!this.panes.split) return;
    aim(renderer, viser.canvas, at);
    show(viser, ["reference", "robot"]);
  }

  /** @param {Viser} viser @param {Renderer} renderer */
  #after(viser, renderer) {
    const { split, more } = this.panes;
    if (!split && !more.size) return;
    /** @type {Draw} */
    const draw = (camera, at) => {
      shape(camera, at);
      aim(renderer, viser.canvas, at);
      renderer.render(viser.scene, camera);
    };
    if (split) {
      show(viser, ["human"]);
      this.person = this.#beside(viser);
      draw(this.person, this.panes.of(viser, "human").at);
      show(viser, ["human", "reference", "robot"]);
    }
    for (const picture of more) picture(draw);
    const { clientWidth: width, clientHeight: height } = viser.canvas;
    aim(renderer, viser.canvas, { x: 0, y: 0, width, height });
    renderer.setScissorTest(false);
  }

  /** The person's camera looks at them as the robots' at these. @param {Viser} viser */
  #beside(viser) {
    const { camera, cameraControl, nodeRefFromName } = viser;
    const made = this.person ?? camera.clone();
    const [human, caption] = [nodeRefFromName["/human"], nodeRefFromName["/human/caption"]];
    const at = cameraControl?.getTarget(camera.position.clone());
    if (!at || !human || !caption) return made;
    const person = human.localToWorld(Object.assign(caption.position.clone(), { z: PERSON }));
    const back = camera.position.clone().sub(at).multiplyScalar(NEARER);
    made.position.copy(person).add(back);
    made.quaternion.copy(camera.quaternion);
    const { width, height } = this.panes.of(viser, "human").at;
    made.setViewOffset(width, height, -this.panes.covered / 2, 0, width, height);
    return made;
  }
}

/** As wide as what it is for. @param {Camera3D} camera @param {Rect} at */
function shape(camera, { width, height }) {
  const aspect = width / height;
  if (!(aspect > 0) || Math.abs(camera.aspect - aspect) < 1e-6) return;
  camera.aspect = aspect;
  camera.updateProjectionMatrix();
}

/**
 * What is drawn next is drawn there.
 *
 * @param {Renderer} renderer @param {HTMLCanvasElement} canvas @param {Rect} at
 */
function aim(renderer, canvas, { x, y, width, height }) {
  const bottom = canvas.clientHeight - y - height;
  renderer.setViewport(x, bottom, width, height);
  renderer.setScissor(x, bottom, width, height);
  renderer.setScissorTest(true);
}

/** Of the figures only these. @param {Viser} viser @param {string[]} figures */
function show({ nodeRefFromName }, figures) {
  for (const figure of ["human", "reference", "robot"]) {
    const node = nodeRefFromName[`/${figure}`];
    if (node) node.visible = figures.includes(figure);
  }
}
