// vog-view.d.ts: types of the module vog-view.js (docs/web_element.md).
export type Vector = [number, number, number];
/** 'head', a direction, or a text: 'camera:0,1,1=0.4', with a strength. */
export type Light = Vector | string;
export interface Camera { eye: Vector; look_at: Vector; up?: Vector; fov_degrees?: number; orthographic_width?: number }
export interface TransferFunction {
  name?: string;
  colors: [number, number, number, number][];
  opacity?: [number, number][];
  domain?: [number, number];
  unit_distance?: number;
  gradient_opacity?: [number, number][];
}

/** Words of a picture's request (docs/formats.md); null: the default. */
export interface PictureSettings {
  show?: 'T' | 'column' | 'mean' | 'deviation' | 'volume' | 'maximum' | null;
  field?: string | null;
  tf?: string | TransferFunction | null;
  range?: [number, number] | null;
  scale?: 'auto' | 'linear' | 'log' | null;
  unit_distance?: number | null;
  window?: [number, number] | null;
  bands?: [number, number | null, Vector, number][] | null;
  threshold?: number | null;
  /** Pairs of a magnitude of the field's gradient, ascending, and a factor of the extinction, 0 to 1. */
  gradient_opacity?: [number, number][] | null;
  extinction?: number | 'auto' | null;
  blend?: boolean | null;
  background?: 'black' | 'white' | 'transparent' | 'system' | Vector | [number, number, number, number] | null;
  light?: 'studio' | Light | Light[] | null;
  light_weights?: [number, number, number, number] | null;
  shadows?: boolean | null;
  clip_lights?: boolean | null;
  light_from?: Light | Light[] | null;
  ambient_occlusion?: boolean | null;
  scattering?: number | null;
  asymmetry?: number | null;
  clip?: [number, number, number, number, number, number] | null;
  clip_planes?: [number, number, number, number][] | null;
  camera?: Partial<Camera> | null;
}
/** Words of a view alone. */
export interface ViewSettings {
  /** Which of several models, 1 the first. */
  model?: number | null;
  /** Factor on the extinction of T, 1/64 to 64. */
  exposure?: number | null;
  /** Error that coarse parts may have, pixels of the screen, 0.5 to 32. */
  pixel_error?: number | null;
  /** Largest memory, MB. */
  memory?: number | null;
  /** Largest number of Gaussians. */
  most?: number | null;
  /** Sub-frames that smooth a picture at rest, 1 to 64; with 1 it is `vog render`'s. */
  subframes?: number | null;
  /** Whether hands and keys change nothing. */
  still?: boolean | null;
}
export interface Settings extends PictureSettings, ViewSettings {}
/** Value of a word now: the view's own words always have one. */
export type Value<Word extends keyof Settings> = NonNullable<Settings[Word]> | (Word extends keyof ViewSettings ? never : null);

export interface ViewEvents {
  change: { request: PictureSettings & { size: [number, number] } };
  /** fatal: there is no picture. */
  error: { message: string; fatal: boolean };
  /** bytes that have come, files under way, error of the picture in pixels, whether memory bounds it. */
  progress: { loaded: number; toCome: number; error: number; isFull: boolean };
  /** Numbers below the pointer, a line each. */
  probe: { lines: string[] };
}

export interface ViewModel {
  name: string;
  shows: string[];
  fields: { name: string; unit: string; lower: number; upper: number }[];
}

type Words = { [Word in keyof Settings]-?: NonNullable<Settings[Word]> | null };
export interface VogView extends Words {
  addEventListener<Name extends keyof ViewEvents>(name: Name, listener: (this: VogView, event: CustomEvent<ViewEvents[Name]>) => void, options?: boolean | AddEventListenerOptions): void;
  addEventListener<Name extends keyof HTMLElementEventMap>(name: Name, listener: (this: VogView, event: HTMLElementEventMap[Name]) => void, options?: boolean | AddEventListenerOptions): void;
  addEventListener(name: string, listener: EventListenerOrEventListenerObject, options?: boolean | AddEventListenerOptions): void;
}
export class VogView extends HTMLElement {
  /** Makes the worker that decodes; where it throws, the page's own thread decodes. */
  static worker: () => Worker;
  src: string;
  /** The files of a site's folder in place of an address, by their names in it. */
  files: ((name: string) => Uint8Array | undefined | Promise<Uint8Array | undefined>) | null;
  /** What the picture shows, for those who hear it. */
  label: string;
  readonly ready: Promise<VogView>;
  readonly request: ViewEvents['change']['request'] | null;
  link: string;
  readonly models: ViewModel[];
  /** size: of the picture that a camera of another view is for, as in `request`. */
  set(settings: Settings & { size?: [number, number] }): string[];
  get<Word extends keyof Settings>(word: Word): Value<Word>;
  on<Name extends keyof ViewEvents>(name: Name, listener: (detail: ViewEvents[Name]) => void): () => void;
  picture(): Promise<Blob>;
  dispose(): void;
}
declare global {
  interface HTMLElementTagNameMap { 'vog-view': VogView }
}
