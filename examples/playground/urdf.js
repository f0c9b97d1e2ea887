// A URDF as the numbers of playground.hpp's `Robot`: six joints of its arm that turn, the bodies that they move.
import {Euler, Matrix4, Quaternion, Vector3} from 'three';

const wanted = 6, most_bodies = 64;
const triple = (e, name, otherwise) => {
  const text = e && e.getAttribute(name), out = text ? text.trim().split(/\s+/).map(Number) : otherwise;
  if (out.length !== 3 || !out.every(Number.isFinite)) throw new Error(`${name}="${text}": three numbers are asked for`);
  return out;
};
const number = (e, name, otherwise = 0) => {
  const x = e && e.hasAttribute(name) ? Number(e.getAttribute(name)) : otherwise;
  if (!Number.isFinite(x)) throw new Error(`${name}="${e.getAttribute(name)}": a number is asked for`);
  return x;
};
/// 60 rad/s, beyond which a file means degrees, or nothing.
const fastest = 60, known = (x, most) => x > 0 && x <= most ? x : 0;
const child = (e, name) => Array.from(e.children).find(c => c.tagName === name);
/// The pose of an `<origin>`: roll, pitch, yaw about the fixed axes.
function origin(e) {
  const at = child(e, 'origin'), [x, y, z] = triple(at, 'xyz', [0, 0, 0]), [roll, pitch, yaw] = triple(at, 'rpy', [0, 0, 0]);
  return new Matrix4().makeRotationFromEuler(new Euler(roll, pitch, yaw, 'ZYX')).setPosition(x, y, z);
}
function axis(e) {
  const v = new Vector3(...triple(child(e, 'axis'), 'xyz', [1, 0, 0]));
  if (v.length() < 1e-9) throw new Error(`joint "${e.getAttribute('name')}": an axis without direction`);
  return v.normalize();
}
const inverse = m => new Matrix4().getInverse(m);
/// Axes and origin, as `Robot::Place` has them.
const place = m => [...m.elements.slice(0, 3), ...m.elements.slice(4, 7), ...m.elements.slice(8, 11), ...m.elements.slice(12, 15)];
const limits = e => {
  const l = child(e, 'limit'), endless = e.getAttribute('type') === 'continuous' || !l;
  return {lower: endless ? 0 : number(l, 'lower'), upper: endless ? 0 : number(l, 'upper'), velocity: known(number(l, 'velocity'), fastest), torque: known(number(l, 'effort'), 1e5)};
};
/// Where a joint that is locked stands: at 0, or as near as its limits allow.
const stands = e => {
  const {lower, upper} = limits(e);
  return lower < upper ? Math.min(Math.max(0, lower), upper) : 0;
};
const turns = e => ['revolute', 'continuous'].includes(e.getAttribute('type')) && !child(e, 'mimic');
const slides = e => e.getAttribute('type') === 'prismatic';

/// Throws, in words, what is no arm of six or seven joints. @return name, words for the visitor, numbers.
export function readRobot(text) {
  const xml = new DOMParser().parseFromString(text, 'text/xml'), root = xml.documentElement;
  if (xml.querySelector('parsererror')) throw new Error('no XML, or cut off');
  if (root.tagName !== 'robot') throw new Error(`no URDF: its root is <${root.tagName}>, not <robot>`);
  const links = new Map(Array.from(root.children).filter(e => e.tagName === 'link').map(e => [e.getAttribute('name'), e]));
  const joints = Array.from(root.children).filter(e => e.tagName === 'joint');
  if (!joints.length) throw new Error(root.outerHTML.includes('xacro:') ? 'a xacro that was not expanded: `xacro FILE > robot.urdf` makes the URDF of it' : 'no joint');
  const below = new Map(), carried = new Set();
  for (const e of joints) {
    const [parent, link] = ['parent', 'child'].map(k => child(e, k) && child(e, k).getAttribute('link'));
    if (!links.has(parent) || !links.has(link)) throw new Error(`joint "${e.getAttribute('name')}": its parent or child is no link of the file`);
    if (carried.has(link)) throw new Error(`link "${link}" hangs on two joints`);
    carried.add(link);
    if (!below.has(parent)) below.set(parent, []);
    below.get(parent).push({e, link});
  }
  const base = Array.from(links.keys()).find(name => !carried.has(name));
  if (base === undefined) throw new Error('a loop: every link hangs on a joint');

  // Down the branch that turns most; fingers begin where an arm of six joints or more parts.
  const moving = link => (below.get(link) || []).reduce((n, {e, link}) => Math.max(n, (turns(e) ? 1 : 0) + moving(link)), 0);
  const chain = [];
  for (let link = base; below.has(link);) {
    const branches = below.get(link), most = Math.max(...branches.map(b => (turns(b.e) ? 1 : 0) + moving(b.link)));
    const turned = chain.filter(b => turns(b.e)).length, moves = b => turns(b.e) || slides(b.e) || moving(b.link) > 0;
    if (turned >= wanted && branches.filter(moves).length > 1) break;
    const next = branches.find(b => (turns(b.e) ? 1 : 0) + moving(b.link) === most);
    chain.push(next), link = next.link;
  }
  let arm = chain.filter(b => turns(b.e));
  if (arm.length < wanted) throw new Error(`${arm.length} joints of its longest arm turn; the playground moves arms of six, or of seven with one locked`);
  const named = arm.length;
  arm = arm.slice(-7);
  if (arm.length === 7) arm.splice(2, 1);  // the one that the other six can do without
  const locked = chain.filter(b => (turns(b.e) || slides(b.e)) && !arm.includes(b)).map(b => b.e.getAttribute('name'));

  // From the base outwards: the frame of a joint has its z on the joint's axis.
  const numbers = {joint: [], body: [], tip: new Vector3()};
  let massless = false;
  const weigh = (e, X, joint) => {
    const i = child(e, 'inertial');
    if (!i || joint < 0) return 0;
    const t = child(i, 'inertia'), mass = number(child(i, 'mass'), 'value');
    if (mass > 0) numbers.body.push([joint, ...place(new Matrix4().multiplyMatrices(X, origin(i))), mass, ...['ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz'].map(k => number(t, k))]);
    return mass;
  };
  /// Everything that hangs on a link: the chain's next joint, and what stands still beside it.
  const walk = (link, X, joint) => {
    weigh(links.get(link), X, joint);
    for (const {e, link: next} of below.get(link) || []) {
      const at = new Matrix4().multiplyMatrices(X, origin(e)), k = arm.findIndex(b => b.e === e);
      if (k < 0) {
        const x = stands(e), still = turns(e) ? new Matrix4().makeRotationAxis(axis(e), x)
          : slides(e) ? new Matrix4().makeTranslation(...axis(e).multiplyScalar(x).toArray()) : new Matrix4();
        at.multiply(still);
        if (joint === wanted - 1 && chain.some(b => b.e === e)) numbers.tip.setFromMatrixPosition(at);
        walk(next, at, joint);
      } else {
        const turn = new Matrix4().makeRotationFromQuaternion(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), axis(e)));
        const l = limits(e);
        if (l.lower > l.upper) throw new Error(`joint "${e.getAttribute('name')}": its lower limit lies above its upper`);
        numbers.joint[k] = [...place(new Matrix4().multiplyMatrices(at, turn)), l.lower, l.upper, l.velocity, l.torque];
        walk(next, inverse(turn), k);
      }
    }
  };
  walk(base, new Matrix4(), -1);
  for (let k = 0; k < wanted; ++k) massless = massless || !numbers.body.some(b => b[0] === k);
  if (numbers.body.length > most_bodies) throw new Error(`${numbers.body.length} links with mass, at most ${most_bodies}`);
  if (numbers.tip.length() < 0.03) numbers.tip.set(0, 0, 0.08);  // a wrist without a flange: it is drawn nevertheless
  const words = [];
  if (locked.length) words.push(`locked: ${locked.join(', ')}`);
  if (massless) words.push('links without mass count as cylinders');
  if (named > 7) words.push(`the last seven of ${named} joints`);
  const bodies = Array.from({length: most_bodies}, (_, i) => numbers.body[i] || new Array(20).fill(0));
  return {name: root.getAttribute('name') || 'a robot', words: words.join('; '), joints: arm.map(b => b.e.getAttribute('name')),
    numbers: [1, numbers.body.length, ...numbers.joint.flat(), ...bodies.flat(), ...numbers.tip.toArray()]};
}
