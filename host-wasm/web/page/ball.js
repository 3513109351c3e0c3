// A ball that the user throws. It flies freely, the cloth slows it down, and it bounces off the other colliders.

import { add, dot, point, sub, unit } from "./vector.js";

/** Radius, m, mass, kg, and speed, m/s. A light ball would be stopped by the cloth at once. */
const RADIUS = 0.09;
const MASS = 1;
const SPEED = 4;
/** Time after which it is gone, s. */
const LIFE = 3;
/** Share of the speed that a bounce leaves. */
const BOUNCE = 0.4;
/** Layers of cloth that have room between the ball and another collider. */
const LAYERS = 6;
/** A place where nothing is, m. */
const AWAY = [0, 100, 0];

/** A scene with the ball as its last collider. Scenes without contact get none. */
export function withBall(scene) {
  if (!scene.contact) return scene;
  return { ...scene, collider: [...(scene.collider ?? []), { shape: "sphere", center: AWAY, radius: RADIUS }] };
}

/** A scene without the ball. */
export function withoutBall({ collider, ...scene }) {
  return collider.length > 1 ? { ...scene, collider: collider.slice(0, -1) } : scene;
}

/** The bodies without the ball, unless it flies. */
export const seen = (bodies, ball) => (ball && !ball.isFlying ? bodies.slice(0, -1) : bodies);

export class Ball {
  #cloth;
  #number;
  #repeat;
  #gravity;
  /** Distance from other colliders at which it bounces off, m. */
  #room;
  #velocity;
  #place;
  #left = 0;
  /** Whether it still moves to the place where it starts, switched off, so that it does not jump through the cloth. */
  #isComing = false;

  /** `repeat(action)` repeats an action on the collider in the reference. */
  constructor(cloth, repeat) {
    this.#cloth = cloth;
    this.#number = cloth.bodies().length - 1;
    this.#repeat = repeat;
    const { gravity, contact } = cloth.scene;
    this.#gravity = Array.isArray(gravity) ? gravity : [0, 0, 0];
    this.#room = RADIUS + LAYERS * contact.thickness;
    cloth.measureImpulses();
    cloth.switchCollider(this.#number, false);
  }

  /** The action that brings a reference to the present state: it is switched off. */
  state() {
    return { ask: "switchCollider", collider: this.#number, isOn: false };
  }

  /** Whether it flies, or comes to the place where it starts. */
  get isHere() {
    return this.isFlying || this.#isComing;
  }

  get isFlying() {
    return this.#left > 0;
  }

  #show(isOn) {
    this.#cloth.switchCollider(this.#number, isOn);
    this.#repeat({ ask: "switchCollider", collider: this.#number, isOn });
  }

  #move(seconds) {
    this.#cloth.moveCollider(this.#number, this.#place, undefined, seconds);
    this.#repeat({ ask: "moveCollider", collider: this.#number, place: this.#place, seconds });
  }

  /** Throws it from a place towards another, after the next step. */
  fly(from, to) {
    if (this.isFlying) this.stop();
    this.#place = from;
    this.#velocity = unit(sub(to, from)).map((x) => SPEED * x);
    this.#isComing = true;
  }

  /** Moves it within the next step. */
  before(seconds) {
    if (this.#isComing) this.#move(seconds);
    if (!this.isFlying) return;
    this.#left -= seconds;
    if (!this.isFlying) return this.stop();
    this.#velocity = add(this.#velocity, this.#gravity, seconds);
    for (const body of this.#cloth.bodies().slice(0, -1)) if (body.shape !== "mesh") this.#bounce(body, seconds);
    this.#place = add(this.#place, this.#velocity, seconds);
    this.#move(seconds);
  }

  /** Turns the velocity back where the next step would lead too near to a body. */
  #bounce(body, seconds) {
    const next = add(this.#place, this.#velocity, seconds);
    const off = sub(next, nearest(body, next));
    const distance = body.shape === "plane" ? dot(sub(next, point(body.points, 0)), body.normal) : Math.hypot(...off) - body.radius;
    if (distance > this.#room) return;
    const normal = body.shape === "plane" ? body.normal : unit(off);
    const towards = dot(this.#velocity, normal);
    if (towards < 0) this.#velocity = add(this.#velocity, normal, -(1 + BOUNCE) * towards);
  }

  /** Takes the impulse of the cloth in the last step. */
  after() {
    if (this.#isComing) {
      // Throws where the cloth leaves no room for it. The caller stops it then.
      this.#show(true);
      this.#isComing = false;
      this.#left = LIFE;
    }
    const { linear } = this.#cloth.takeImpulse(this.#number);
    if (this.isFlying) this.#velocity = add(this.#velocity, linear, 1 / MASS);
  }

  /** Takes it away. */
  stop() {
    this.#left = 0;
    this.#isComing = false;
    this.#show(false);
  }
}

/** The point nearest to a place: of the middle of a sphere, of the axis of a capsule, or of a box. */
function nearest(body, place) {
  const from = point(body.points, 0);
  if (body.shape === "capsule") return along(from, point(body.points, 1), place);
  if (body.shape !== "box") return from;
  // The corners 1, 2 and 4 lie along the edges from the corner 0.
  return [1, 2, 4].reduce((near, k) => {
    const edge = sub(point(body.points, k), from);
    const part = Math.max(0, Math.min(1, dot(sub(place, from), edge) / dot(edge, edge)));
    return add(near, edge, part);
  }, from);
}

function along(a, b, place) {
  const edge = sub(b, a);
  const part = Math.max(0, Math.min(1, dot(sub(place, a), edge) / (dot(edge, edge) || 1)));
  return add(a, edge, part);
}
