// Figures that are seen through.

/** @import { Thing3D, Viser } from "../types/page.js" */

/** How much of a ghost is seen. */
const GHOST = 0.3;

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
