// Figures that are seen through.

/** @import { Looks } from "./looks.js" */
/** @import { Thing3D, Viser } from "../types/page.js" */

/** How much of a ghost is seen. */
const GHOST = 0.3;

/** Each figure as its look says. @param {Viser} viser @param {Looks} looks */
export function hauntAll(viser, looks) {
  for (const figure of ["human", "reference", "robot"])
    haunt(viser, figure, looks.of(figure) === "ghost");
}

/**
 * Make a figure a ghost, or as it was: its own meshes, not those in its world, as props.
 *
 * @param {Viser} viser @param {string} figure @param {boolean} ghost
 */
export function haunt({ nodeRefFromName, requestRender }, figure, ghost) {
  const world = nodeRefFromName[`/${figure}/world`];
  /** @param {Thing3D} node */
  const visit = (node) => {
    if (node === world) return;
    const { material } = node;
    if (material && node.isMesh && Boolean(material.userData.own) !== ghost) {
      const { opacity, transparent, depthWrite } = material;
      const own = material.userData.own ?? { opacity, transparent, depthWrite };
      const thin = { opacity: GHOST * own.opacity, transparent: true, depthWrite: false };
      Object.assign(material, ghost ? thin : own);
      material.userData.own = ghost ? own : null;
      material.needsUpdate = true; // it is another shader
      requestRender();
    }
    node.children.forEach(visit);
  };
  const node = nodeRefFromName[`/${figure}`];
  node?.children.forEach(visit);
}
