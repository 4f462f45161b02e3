// Where things of the world are on the drawing, and how the arm bends to reach its hand.

import type { Scene } from "./messages";

/** To the right, ahead, up; in cells. */
export type Place = readonly [number, number, number];

export type Point = readonly [number, number];

/** Drawing units of a cell. */
export const CELL = 60;

/** How much of a height is seen. */
const RISE = 0.62;

/** The drawing should not be flatter than this. */
const FLATTEST = 1.9;

/** How steeply one looks down, by how long a cell ahead is drawn. */
const [LOWEST_LOOK, STEEPEST_LOOK] = [0.62, 1.05];

/** Cells from the states to the edge of the table, and on beyond it. */
const TABLE_MARGIN = 1;
const SIDE = 0.55;
const FRONT = 1.8;
const BEHIND = 1.35;

/** Height of the hand over the table and of the shoulder. */
export const HAND_HEIGHT = 0.75;
const SHOULDER_HEIGHT = 1.2;

/** How far an elbow goes up, of what stiff links would need. */
const BEND = 0.5;

export interface Box {
  left: number;
  right: number;
  near: number;
  far: number;
}

export class View {
  /** `[X]` the states' places on the table. */
  readonly places: readonly Place[];
  /** The table. */
  readonly table: Box;
  readonly shoulder: Place;
  /** Of the drawing. */
  readonly width: number;
  readonly height: number;
  readonly #look: number;
  readonly #reach: number;

  constructor(scene: Pick<Scene, "positions" | "free">) {
    const size = spacing(scene);
    this.places = scene.positions.map(([right, ahead]) => [right / size, ahead / size, 0] as const);
    const rights = this.places.map(([right]) => right);
    const aheads = this.places.map(([, ahead]) => ahead);
    this.table = {
      left: Math.min(...rights) - TABLE_MARGIN,
      right: Math.max(...rights) + TABLE_MARGIN,
      near: Math.min(...aheads) - TABLE_MARGIN,
      far: Math.max(...aheads) + TABLE_MARGIN,
    };
    const { left, right, near, far } = this.table;
    const wide = right - left + 2 * SIDE;
    const look = (wide / FLATTEST - FRONT - BEHIND) / (far - near);
    this.#look = Math.min(STEEPEST_LOOK, Math.max(LOWEST_LOOK, look));
    this.width = wide * CELL;
    this.height = ((far - near) * this.#look + FRONT + BEHIND) * CELL;
    this.shoulder = [(left + right) / 2, near - 0.75, SHOULDER_HEIGHT];
    const far_away = this.places.map((place) => apart(this.shoulder, raised(place)));
    this.#reach = (Math.max(...far_away) / 2) * 1.03;
  }

  /** Where `place` is drawn. */
  at([right, ahead, up]: Place): Point {
    const { left, far } = this.table;
    return [
      (right - left + SIDE) * CELL,
      ((far - ahead) * this.#look + BEHIND - up * RISE) * CELL,
    ];
  }

  /** How long a cell ahead is drawn, of a cell to the right. */
  get look(): number {
    return this.#look;
  }

  /**
   * The elbow of an arm whose hand is over `place`. The arm bends upwards in the plane through
   * shoulder and hand, so that it looks the same to the left as to the right.
   */
  elbow(place: Place): Place {
    const hand = raised(place);
    const middle = this.shoulder.map((value, i) => (value + (hand[i] ?? 0)) / 2);
    const half = apart(this.shoulder, hand) / 2;
    const up = BEND * Math.sqrt(Math.max(0, this.#reach ** 2 - half ** 2));
    return [middle[0] ?? 0, middle[1] ?? 0, (middle[2] ?? 0) + up];
  }
}

export function raised([right, ahead]: Place, up = HAND_HEIGHT): Place {
  return [right, ahead, up];
}

function apart(a: Place, b: Place): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/** The usual distance of neighbouring states: the middle one of all. */
function spacing({ positions, free }: Pick<Scene, "positions" | "free">): number {
  const lengths = free
    .map(([a, b]) => {
      const [p, q] = [positions[a], positions[b]];
      return p && q ? Math.hypot(p[0] - q[0], p[1] - q[1]) : 0;
    })
    .filter((value) => value > 0)
    .sort((a, b) => a - b);
  return lengths[Math.floor(lengths.length / 2)] ?? 1;
}
