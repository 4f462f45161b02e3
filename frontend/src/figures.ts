// How the parts of the scene look.

import type { Goal, Scene, Steering } from "./messages";
import { set, shape } from "./shapes";
import { CELL, type Place, type Point, type View } from "./view";

/** All bottles look alike: what people think of a colour is no part of the study. */
const [GLASS, GLASS_EDGE] = ["#2f7d5b", "#1f5a40"];

const [TABLE, TABLE_EDGE, TABLE_LEG] = ["#ead9bd", "#c9b28c", "#a48a62"];

const THICKNESS = 0.28;

function path(points: readonly Point[]): string {
  return points.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
}

/** The table with the places where the hand can be. */
export function table(view: View, scene: Scene): SVGGElement {
  const { left, right, near, far } = view.table;
  const [x, y] = view.at([left, far, 0]);
  const [x2, y2] = view.at([right, near, 0]);
  const [round, deep] = [0.35 * CELL, THICKNESS * CELL];
  const top = { x, y, width: x2 - x, height: y2 - y, rx: round };
  const lines = scene.free.map(([a, b]) => {
    const ends = [view.places[a], view.places[b]].filter((place) => place !== undefined);
    return path(ends.map((place) => view.at(place)));
  });
  const dots = view.places.map((place) => {
    const [cx, cy] = view.at(place);
    return shape("circle", { cx, cy, r: 3.4, fill: "#a98f66" });
  });
  const mats = scene.goals.flatMap(({ states }) => states.map((state) => mat(view, state)));
  // The floor goes on where the element is wider than the drawing.
  const everywhere = { x: -view.width, width: 3 * view.width, height: view.height };
  const leg = (at: number) =>
    shape("rect", { x: at - 9, y: y2, width: 18, height: view.height - y2, fill: TABLE_LEG });
  return shape(
    "g",
    {},
    shape("rect", { ...everywhere, y: y2 - 0.2 * CELL, fill: "#cfd6db" }),
    leg(x + 0.7 * CELL),
    leg(x2 - 0.7 * CELL),
    shape("rect", { ...top, y: y + deep, fill: TABLE_EDGE }),
    shape("rect", { ...top, fill: TABLE }),
    shape("rect", {
      ...top,
      x: x + 5,
      y: y + 5,
      width: top.width - 10,
      height: top.height - 10,
      rx: round - 4,
      fill: "none",
      stroke: "#f4e8d3",
      "stroke-width": 3,
    }),
    shape("path", { d: lines.join(""), fill: "none", stroke: "#d3bf9c", "stroke-width": 2.5 }),
    ...dots,
    ...mats,
  );
}

function mat(view: View, state: number): SVGElement {
  const [cx, cy] = view.at(view.places[state] ?? [0, 0, 0]);
  const rx = 0.44 * CELL;
  return shape("ellipse", {
    cx,
    cy,
    rx,
    ry: rx * Math.min(1, view.look),
    fill: "#fbf6ec",
    stroke: "#8c7650",
    "stroke-width": 2.5,
  });
}

export interface Bottle {
  whole: SVGGElement;
  /** The part that is lifted. */
  body: SVGGElement;
  /** Write the name so large, in drawing units. */
  label(size: number): void;
}

/** Width of a letter, of its height: a little more than usual. */
const LETTER = 0.62;

/** A bottle at the middle of a goal, with its name. */
export function bottle(view: View, goal: Goal): Bottle {
  const places = goal.states.map((state) => view.places[state] ?? ([0, 0, 0] as const));
  const mean = (i: 0 | 1) => places.reduce((sum, place) => sum + place[i], 0) / places.length;
  const [x, y] = view.at([mean(0), mean(1), 0]);
  const u = CELL / 60;
  const outline =
    `M${-11 * u} 0V${-34 * u}C${-11 * u} ${-44 * u} ${-5 * u} ${-46 * u} ${-5 * u} ${-55 * u}` +
    `V${-66 * u}H${5 * u}V${-55 * u}C${5 * u} ${-46 * u} ${11 * u} ${-44 * u} ${11 * u} ${-34 * u}V0` +
    `A${11 * u} ${4.5 * u} 0 0 1 ${-11 * u} 0Z`;
  const name = shape(
    "text",
    {
      "text-anchor": "middle",
      "font-weight": 650,
      fill: "#1c2733",
      stroke: "#fbf6ec",
      "stroke-linejoin": "round",
      "paint-order": "stroke",
    },
    goal.name,
  );
  const glass = shape(
    "g",
    { transform: `translate(${x.toFixed(2)} ${y.toFixed(2)})` },
    shape("path", { d: outline, fill: GLASS, stroke: GLASS_EDGE, "stroke-width": 2 }),
    shape("rect", { x: -5.5 * u, y: -70 * u, width: 11 * u, height: 7 * u, rx: 2, fill: "#40464d" }),
    shape("rect", { x: -11 * u, y: -28 * u, width: 22 * u, height: 16 * u, fill: "#fbf6ec" }),
    shape("path", {
      d: `M${-6.5 * u} ${-5 * u}V${-35 * u}`,
      stroke: "#fff",
      "stroke-opacity": 0.45,
      "stroke-width": 3,
      "stroke-linecap": "round",
    }),
  );
  const shadow = shape("ellipse", {
    cx: x + 7,
    cy: y + 1,
    rx: 15 * u,
    ry: 6 * u,
    fill: "#6b5634",
    "fill-opacity": 0.35,
  });
  const body = shape("g", {}, glass);
  return {
    whole: shape("g", {}, shadow, name, body),
    body,
    label(size) {
      const half = (LETTER * size * goal.name.length) / 2;
      set(name, {
        x: Math.max(half, Math.min(view.width - half, x)),
        y: y + 0.44 * CELL * Math.min(1, view.look) + size,
        "font-size": size,
        "stroke-width": size / 4,
      });
    },
  };
}

export interface Arm {
  links: SVGGElement;
  shadow: SVGElement;
  bend(view: View, shoulder: Place, elbow: Place, hand: Place, ground: Place): void;
}

/** The arm: pedestal, two links, joints. */
export function arm(): Arm {
  const thick = (width: number, stroke: string) =>
    shape("path", {
      fill: "none",
      stroke,
      "stroke-width": width,
      "stroke-linecap": "round",
      "stroke-linejoin": "round",
    });
  const [edge, fill, shine] = [thick(31, "#3f4b57"), thick(26, "#e9edf0"), thick(5, "#ffffff")];
  const forearm = [thick(25, "#3f4b57"), thick(20, "#d5dce2")] as const;
  const joint = (r: number) =>
    shape(
      "g",
      {},
      shape("circle", { r, fill: "#0b5a66", stroke: "#3f4b57", "stroke-width": 2.5 }),
      shape("circle", { r: r * 0.45, fill: "#7fb3ba" }),
    );
  const [shoulderJoint, elbowJoint] = [joint(21), joint(15)];
  const pedestal = shape("path", { fill: "#7d8a96", stroke: "#3f4b57", "stroke-width": 2.5 });
  const shadow = shape("ellipse", { fill: "#4a3a1c", "fill-opacity": 0.35 });
  const links = shape("g", {}, pedestal, edge, fill, shine, shoulderJoint, ...forearm, elbowJoint);
  return {
    links,
    shadow,
    bend(view, shoulder, elbow, hand, ground) {
      const [s, e, h, g] = [view.at(shoulder), view.at(elbow), view.at(hand), view.at(ground)];
      const foot = view.at([shoulder[0], shoulder[1], 0]);
      const below = view.height + 20;
      set(pedestal, {
        d:
          `M${s[0] - 20} ${s[1]}H${s[0] + 20}L${s[0] + 30} ${foot[1]}V${below}` +
          `H${s[0] - 30}V${foot[1]}Z`,
      });
      for (const part of [edge, fill]) set(part, { d: path([s, e]) });
      set(shine, { d: path([along(s, e, 0.15), along(s, e, 0.8)]) });
      for (const part of forearm) set(part, { d: path([e, h]) });
      set(shoulderJoint, { transform: `translate(${s[0].toFixed(2)} ${s[1].toFixed(2)})` });
      set(elbowJoint, { transform: `translate(${e[0].toFixed(2)} ${e[1].toFixed(2)})` });
      set(shadow, { cx: g[0], cy: g[1], rx: 0.36 * CELL, ry: 0.36 * CELL * Math.min(1, view.look) });
    },
  };
}

function along(a: Point, b: Point, part: number): Point {
  return [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])];
}

/** The hand with two fingers; with the class "closed" they close. */
export function gripper(): SVGGElement {
  const finger = (side: string) =>
    shape("path", {
      class: `finger ${side}`,
      d: side === "left" ? "M-8 8C-25 12-25 26-17 40L-12 38C-17 26-15 19-4 15Z"
        : "M8 8C25 12 25 26 17 40L12 38C17 26 15 19 4 15Z",
      fill: "#55626e",
      stroke: "#2c3640",
      "stroke-width": 2,
    });
  return shape(
    "g",
    { class: "gripper" },
    finger("left"),
    finger("right"),
    shape("rect", {
      x: -17,
      y: -13,
      width: 34,
      height: 26,
      rx: 9,
      fill: "#f3b14b",
      stroke: "#2c3640",
      "stroke-width": 2.5,
    }),
    shape("circle", { r: 5, fill: "#2c3640" }),
  );
}

/** The input that is held, beside the place below the hand: an arrow, or the input's name. */
export function arrow(view: View, { name, direction }: Steering): SVGElement[] {
  const size = Math.hypot(direction[0], direction[1]);
  if (size === 0) {
    const label = { y: 0.8 * CELL, "text-anchor": "middle", "font-size": 0.36 * CELL };
    const look = { fill: "#0b5a66", "font-weight": 700 };
    const halo = { stroke: "#fff", "stroke-width": 6, "paint-order": "stroke" };
    return [shape("text", { ...label, ...look, ...halo }, name)];
  }
  const [right, ahead] = [direction[0] / size, (direction[1] / size) * view.look];
  const turn = (Math.atan2(-ahead, right) * 180) / Math.PI;
  const long = Math.hypot(right, ahead) * CELL;
  const [from, to] = [0.5 * long, 1.32 * long];
  const d = `M${from} -9H${to - 20}V-21L${to} 0L${to - 20} 21V9H${from}Z`;
  return [
    shape("path", {
      d,
      transform: `rotate(${turn.toFixed(2)})`,
      fill: "#0b5a66",
      stroke: "#ffffff",
      "stroke-width": 4,
      "stroke-linejoin": "round",
      "paint-order": "stroke",
    }),
  ];
}
