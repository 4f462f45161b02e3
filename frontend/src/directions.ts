// Which input a push in some direction is: the nearest one by angle.

/** To the right, ahead. */
export type Vector = readonly [number, number];

/** A push farther than this from every input's direction is none of them. */
const WIDEST = (60 * Math.PI) / 180;

/** The input that is held stays so until another one is nearer by this much. */
const STICKY = (8 * Math.PI) / 180;

const NOTHING = 1e-9;

export function length([right, ahead]: Vector): number {
  return Math.hypot(right, ahead);
}

/** The angle between two vectors, from 0 to pi. */
export function angle(a: Vector, b: Vector): number {
  const cosine = (a[0] * b[0] + a[1] * b[1]) / (length(a) * length(b));
  return Math.acos(Math.min(1, Math.max(-1, cosine)));
}

/**
 * The index of the direction nearest to `push`, or null where none is near.
 *
 * `held` is the one so far: of two that are about as near, it stays.
 */
export function nearest(
  directions: readonly Vector[],
  push: Vector,
  held: number | null = null,
): number | null {
  if (length(push) < NOTHING) return null;
  let best: number | null = null;
  let least = WIDEST + NOTHING;
  for (const [i, direction] of directions.entries()) {
    if (length(direction) < NOTHING) continue;
    const apart = angle(direction, push) - (i === held ? STICKY : 0);
    if (apart < least) {
      best = i;
      least = apart;
    }
  }
  return best;
}

/** The inputs that point nowhere; they have names alone. */
export function named(directions: readonly Vector[]): number[] {
  return directions.flatMap((direction, i) => (length(direction) < NOTHING ? [i] : []));
}
