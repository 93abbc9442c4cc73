// The page's words for the API's types, which api.d.ts holds as they were generated.

import type { components, paths } from "./api.js";

type Schemas = components["schemas"];
export type State = Schemas["State"];
export type StateMessage = Schemas["StateMessage"];
export type Tick = Schemas["TickMessage"];
export type SceneInfo = Schemas["SceneInfo"];
export type SceneName = Schemas["SetScene"]["scene"];
export type Pose = Schemas["Pose"];
export type Collect = Schemas["Collect"];
export type Take = Schemas["TakeInfo"];
export type Review = Schemas["Review"];
export type Alignment = Schemas["Alignment"];
export type Suggestion = Schemas["Suggestion"];
export type Curves = Schemas["Timeline"];
export type Series = Schemas["Series"];
export type Task = Schemas["Task"];
export type PlanItem = Schemas["PlanItem"];
export type CoverageMap = Schemas["CoverageMap"];
export type Axis = Schemas["Axis"];
export type Training = Schemas["Training"];
export type StateScores = Schemas["StateScores"];
export type CollectSession = Schemas["CollectSession"];
export type Binned = Schemas["Binned"];
export type Export = Schemas["Export"];
export type Imported = Schemas["Imported"];
export type Edits = Schemas["EditBody"];
export type Rival = Schemas["Rival"];
export type Seek = Schemas["Seek"];
export type Move = Schemas["Transport"];
export type Played = Schemas["Played"];
export type Action = Schemas["CollectAction"]["action"];
export type Gain = Schemas["SetGain"]["name"];

type Method = "get" | "post" | "patch" | "delete";
type Operation<P, M> = P extends keyof paths
  ? M extends keyof paths[P]
    ? NonNullable<paths[P][M]>
    : never
  : never;
type Known<V> = [V] extends [never] ? unknown : V;
type Part<T, K extends string> = T extends { [key in K]?: infer V }
  ? Known<NonNullable<V>>
  : unknown;

/** Paths of the API that answer a method. */
export type PathOf<M extends Method> = {
  [P in keyof paths]: Operation<P, M> extends { responses: object } ? P : never;
}[keyof paths];

/** What a path answers with status 200. */
export type Answer<P, M> =
  Operation<P, M> extends { responses: { 200: { content: { "application/json": infer A } } } }
    ? A
    : never;

/** The JSON a path takes. */
export type Body<P, M> =
  Part<Operation<P, M>, "requestBody"> extends { content: { "application/json": infer B } }
    ? B
    : Record<string, never>;

/** What stands in a path's braces, and its query. */
export type Values<P, M> = Part<Part<Operation<P, M>, "parameters">, "path"> &
  Part<Part<Operation<P, M>, "parameters">, "query">;

/** viser's own state, which it leaves in its window for tests: only what we use of it. */
export interface Viser {
  canvas: HTMLCanvasElement;
  backgroundMaterial?: Material;
  configuredMaxOrbitDistance: number;
  camera: Camera3D;
  cameraControl?: {
    setLookAt(...eyeThenTargetThenGlide: [...number[], boolean]): void;
    setFocalOffset(x: number, y: number, z: number, glide: boolean): void;
    rotate(azimuth: number, polar: number, glide: boolean): void;
    moveTo(x: number, y: number, z: number, glide: boolean): void;
    getTarget(into: Vector): Vector;
    maxPolarAngle: number;
    minDistance: number;
  };
  nodeRefFromName: Record<string, Node3D | undefined>;
  scene: {
    traverse(visit: (thing: Thing3D) => void): void;
    onBeforeRender?: RenderHook;
    onAfterRender?: RenderHook;
  };
  requestRender(): void;
}

type RenderHook = (renderer: Renderer, scene: unknown, camera: unknown) => void;

export interface Renderer {
  render(scene: unknown, camera: Camera3D): void;
  setViewport(x: number, y: number, width: number, height: number): void;
  setScissor(x: number, y: number, width: number, height: number): void;
  setScissorTest(on: boolean): void;
}

export interface Camera3D {
  aspect: number;
  fov: number;
  near: number;
  position: Vector;
  up: Vector;
  quaternion: { copy(other: unknown): void };
  clone(): Camera3D;
  lookAt(at: Vector): void;
  updateProjectionMatrix(): void;
  setViewOffset(...fullThenPart: number[]): void;
}

export interface Vector {
  x: number;
  y: number;
  z: number;
  clone(): Vector;
  copy(other: Vector): Vector;
  add(other: Vector): Vector;
  sub(other: Vector): Vector;
  multiplyScalar(by: number): Vector;
  applyMatrix4(by: unknown): Vector;
  project(camera: unknown): Vector;
  unproject(camera: unknown): Vector;
  toArray(): number[];
}

export interface Node3D {
  visible: boolean;
  position: Vector;
  quaternion: { z: number; set(x: number, y: number, z: number, w: number): void };
  children: Thing3D[];
  add(child: Mesh3D): void;
  traverse(visit: (thing: Thing3D) => void): void;
  getWorldPosition(into: Vector): Vector;
  localToWorld(point: Vector): Vector;
  worldToLocal(point: Vector): Vector;
}

/** Anything that three.js draws: a mesh, a light, a group of them. */
export interface Thing3D extends Node3D {
  isLight?: boolean;
  isHemisphereLight?: boolean;
  isMesh?: boolean;
  castShadow: boolean;
  intensity?: number;
  material: Material;
  geometry: Geometry;
}

/** Of which many are drawn: where each is. */
export interface Batch3D extends Thing3D {
  getMatrixAt(index: number): unknown;
}

/** With the class that it is of, of which more can be made. */
export interface Mesh3D extends Thing3D {
  parent: unknown;
  frustumCulled: boolean;
  removeFromParent(): void;
  constructor: new (geometry: Geometry, material: Material) => Mesh3D;
}

export interface Material {
  type: string;
  opacity: number;
  transparent: boolean;
  depthWrite: boolean;
  toneMapped: boolean;
  needsUpdate: boolean;
  color: { set(css: string): void };
  userData: { own?: Pick<Material, "opacity" | "transparent" | "depthWrite"> | null };
  constructor: new (options: object) => Material;
}

export interface Geometry {
  type: string;
  attributes: Record<"position", Attribute>;
  setAttribute(name: string, attribute: Attribute): void;
  setIndex(corners: number[]): void;
  constructor: new () => Geometry;
}

export interface Attribute {
  array: Float32Array;
  needsUpdate: boolean;
  constructor: new (array: Float32Array, size: number) => Attribute;
}

export interface ViewWindow extends Window {
  /** By frame.js: whether a processor draws it. */
  drawnInSoftware?: boolean;
  __viserMutable?: Viser;
  __viserTestpoints?: { devSettings: { set(settings: { fixedDpr: number }): void } };
}
