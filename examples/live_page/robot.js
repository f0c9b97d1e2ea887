// The robot in three dimensions: links, cells as one mesh coloured from one texture, contacts as arrows.
import {cellsOf, compose, feltClass, inverse, multiply, rotate} from './skin.js';

const numbers = (text, otherwise) => (text || otherwise).trim().split(/\s+/).map(Number);

const turned = ([roll, pitch, yaw]) => {
  const h = [roll, pitch, yaw].map(a => [Math.sin(a / 2), Math.cos(a / 2)]);
  return multiply([0, 0, h[2][0], h[2][1]], multiply([0, h[1][0], 0, h[1][1]], [h[0][0], 0, 0, h[0][1]]));
};
const poseOf = e => ({p: numbers(e && e.getAttribute('xyz'), '0 0 0'), q: turned(numbers(e && e.getAttribute('rpy'), '0 0 0'))});

/// Capsules from joint to joint, for a URDF without shapes that can be drawn (none, or meshes): on a link to each joint that it carries.
function bonesOf(joints) {
  const bones = [];
  for (const {parent, X} of joints) {
    const length = Math.hypot(...X.p);
    if (!(length > 1e-6)) continue;
    const [x, y, z] = X.p.map(v => v / length), h = Math.hypot(y, x, 1 + z);  // turns z onto the way
    bones.push({link: parent, kind: 'capsule', size: [Math.min(0.03, 0.2 * length), length], X: {p: X.p.map(v => v / 2), q: h > 1e-9 ? [-y / h, x / h, 0, (1 + z) / h] : [1, 0, 0, 0]}});
  }
  return bones;
}

/// The shapes of a URDF: {shapes: [{link, kind, size, X}], fixed: [{parent, child, X}]}.
export function shapesOf(urdf) {
  const shapes = [], fixed = [], tree = new DOMParser().parseFromString(urdf, 'text/xml');
  for (const link of tree.querySelectorAll('robot > link'))
    for (const visual of link.querySelectorAll(':scope > visual')) {
      const shape = visual.querySelector('geometry > *');
      if (!shape) continue;
      const get = name => Number(shape.getAttribute(name));
      const size = {cylinder: () => [get('radius'), get('length')], capsule: () => [get('radius'), get('length')],
        sphere: () => [get('radius'), 0], box: () => numbers(shape.getAttribute('size'), '0 0 0')}[shape.tagName];
      if (size) shapes.push({link: link.getAttribute('name'), kind: shape.tagName, size: size(), X: poseOf(visual.querySelector('origin'))});
    }
  const joints = [...tree.querySelectorAll('robot > joint')].map(j => ({type: j.getAttribute('type'), parent: j.querySelector('parent').getAttribute('link'),
    child: j.querySelector('child').getAttribute('link'), X: poseOf(j.querySelector('origin'))}));
  for (const {type, parent, child, X} of joints) if (type === 'fixed') fixed.push({parent, child, X});
  if (shapes.length === 0) shapes.push(...bonesOf(joints));
  return {shapes, fixed};
}
/// The shapes on links that frames are known of: one on another link is told in a known link that is fixed to it.
export function onKnown({shapes, fixed}, known) {
  return shapes.flatMap(s => {
    if (known.has(s.link)) return [s];
    const f = fixed.find(j => j.parent === s.link && known.has(j.child));
    return f ? [{...s, link: f.child, X: compose(inverse(f.X), s.X)}] : [];
  });
}

/// The points of two segments {a, b} that are nearest to each other: one on each.
function nearestOf(one, two) {
  const u = one.b.clone().sub(one.a), v = two.b.clone().sub(two.a), w = one.a.clone().sub(two.a), a = u.dot(u), b = u.dot(v), c = v.dot(v), d = u.dot(w), e = v.dot(w);
  const cut = x => Math.min(1, Math.max(0, x)), det = a * c - b * b;
  let s = det > 1e-9 * a * c ? cut((b * e - c * d) / det) : 0.5, t = c > 0 ? cut((b * s + e) / c) : 0;
  s = a > 0 ? cut((b * t - d) / a) : 0;
  return [one.a.clone().addScaledVector(u, s), two.a.clone().addScaledVector(v, t)];
}

export class RobotView {
  static async create(canvas) {
    const THREE = await import('three');
    const {OrbitControls} = await import('three/addons/controls/OrbitControls.js');
    return new RobotView(canvas, THREE, OrbitControls);
  }
  constructor(canvas, THREE, OrbitControls) {
    this.THREE = THREE, this.canvas = canvas, this.frames = new Map(), this.shapes = new Map(), this.cells = [];
    const context = canvas.getContext('webgl2', {antialias: true});
    if (!context) throw new Error('this browser has no WebGL 2');
    this.renderer = new THREE.WebGLRenderer({canvas, context, antialias: true});
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.05, 20);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(1.5, -1.5, 1.1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0, 0, 0.3);
    this.controls.update();
    this.controls.addEventListener('change', () => { this.moved = true; });
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x666677, 1.1));
    const sun = new THREE.DirectionalLight(0xffffff, 0.7);
    sun.position.set(2, -1, 3);
    this.scene.add(sun);
    const grid = new THREE.GridHelper(2, 20, 0x888888, 0x888888);
    grid.rotation.x = Math.PI / 2;
    grid.material.opacity = 0.25, grid.material.transparent = true;
    this.scene.add(grid);
    this.arrows = [];
    const shaft = new THREE.CylinderGeometry(0.006, 0.006, 1, 12), head = new THREE.CylinderGeometry(0, 0.018, 0.04, 16), red = new THREE.MeshLambertMaterial({color: 0xe040fb}), behind = new THREE.MeshBasicMaterial({color: 0xe040fb, transparent: true, opacity: 0.35, depthFunc: THREE.GreaterDepth, depthWrite: false});
    for (let i = 0; i < 64; ++i) {
      const arrow = new THREE.Group();  // along y, its tip in the origin
      // What the arm hides of it is seen through the arm: a press on the far side.
      [arrow.shaft, arrow.head] = [shaft, head].map(part => new THREE.Group().add(new THREE.Mesh(part, red), new THREE.Mesh(part, behind)));
      arrow.add(arrow.shaft, arrow.head);
      arrow.visible = false;
      this.scene.add(arrow), this.arrows.push(arrow);
    }
    this.joints = [];  // what fills the gaps between the tubes of neighbours
    this.ray = new THREE.Raycaster();
    this.finger = new THREE.Group();  // along y, its tip in the origin
    const skin = new THREE.MeshLambertMaterial({color: 0xe3a008}), round = new THREE.Mesh(new THREE.SphereGeometry(0.012, 20, 12), skin), long = new THREE.Mesh(new THREE.CylinderGeometry(0.012, 0.015, 0.12, 20), skin);
    round.position.y = 0.012, long.position.y = 0.072;
    this.finger.add(round, long);
    this.finger.visible = false;
    this.scene.add(this.finger);
    this.moved = true;
  }
  group(link) {
    let g = this.shapes.get(link);
    if (!g) this.shapes.set(link, g = new this.THREE.Group()), this.scene.add(g);
    return g;
  }
  /// Its links are drawn once their frames are known.
  robot(urdf) { this.urdf = shapesOf(urdf); }
  dress(known) {
    const T = this.THREE, material = new T.MeshLambertMaterial({color: 0x9aa3ad});
    for (const s of onKnown(this.urdf, known)) {
      const body = new T.Group();
      const add = geometry => body.add(new T.Mesh(geometry, material));
      if (s.kind === 'box') add(new T.BoxGeometry(...s.size));
      else if (s.kind === 'sphere') add(new T.SphereGeometry(s.size[0], 24, 16));
      else {
        const tube = new T.Group();  // three's cylinders stand along y, those of a URDF along z
        const [r, l] = s.size;
        this.tubes = (this.tubes || new Map()).set(s.link, {from: new T.Vector3(0, 0, -l / 2), to: new T.Vector3(0, 0, l / 2), r, X: new T.Matrix4().compose(new T.Vector3(...s.X.p), new T.Quaternion(...s.X.q), new T.Vector3(1, 1, 1))});
        tube.add(new T.Mesh(new T.CylinderGeometry(r, r, l, 28), material));
        if (s.kind === 'capsule') for (const y of [-l / 2, l / 2]) { const m = new T.Mesh(new T.SphereGeometry(r, 24, 12), material); m.position.y = y; tube.add(m); }
        tube.rotation.x = Math.PI / 2;
        body.add(tube);
      }
      body.position.set(...s.X.p), body.quaternion.set(...s.X.q);
      this.group(s.link).add(body);
    }
    this.urdf = null;
  }
  layout(skin) {
    const T = this.THREE;
    this.cells = cellsOf(skin);
    this.index = new Map(this.cells.map((c, i) => [c.id, i]));
    this.links = [...new Set(this.cells.map(c => c.link))];
    const n = this.cells.length, width = 64, height = Math.ceil(n / width) || 1;
    this.values = new Float32Array(4 * width * height);
    this.texture = new T.DataTexture(this.values, width, height, T.RGBAFormat, T.FloatType);
    this.texture.minFilter = this.texture.magFilter = T.NearestFilter;
    // A hexagon of 14 mm, two vertices to a corner of two triangles and a bit of air: 6 vertices as two triangles' fan.
    const place = new Float32Array(6 * n * 3), corner = new Float32Array(6 * n * 2), cell = new Float32Array(6 * n), link = new Float32Array(6 * n), index = [];
    const r = 0.0125;
    this.cells.forEach((c, i) => {
      for (let k = 0; k < 6; ++k) {
        const a = k * Math.PI / 3, p = rotate(c.q, [r * Math.cos(a), r * Math.sin(a), 0.0015]);
        place.set([c.p[0] + p[0], c.p[1] + p[1], c.p[2] + p[2]], 3 * (6 * i + k));
        corner.set([Math.cos(a), Math.sin(a)], 2 * (6 * i + k));
        cell[6 * i + k] = i, link[6 * i + k] = this.links.indexOf(c.link);
      }
      for (let k = 1; k < 5; ++k) index.push(6 * i, 6 * i + k, 6 * i + k + 1);
    });
    const geometry = new T.BufferGeometry();
    const attribute = (name, data, each) => { const a = new T.BufferAttribute(data, each); geometry.setAttribute ? geometry.setAttribute(name, a) : geometry.addAttribute(name, a); };
    attribute('position', place, 3), attribute('corner', corner, 2), attribute('cell', cell, 1), attribute('link', link, 1);
    geometry.setIndex(index);
    this.matrices = this.links.map(() => new T.Matrix4());
    const material = new T.ShaderMaterial({
      uniforms: {links: {value: this.matrices}, readings: {value: this.texture}, size: {value: new T.Vector2(width, height)}},
      side: T.DoubleSide,
      vertexShader: `attribute float cell; attribute float link; attribute vec2 corner; uniform mat4 links[${this.links.length || 1}];
        uniform sampler2D readings; uniform vec2 size; varying vec4 reading; varying vec2 at;
        void main() {
          reading = texture2D(readings, (vec2(mod(cell, size.x), floor(cell / size.x)) + 0.5) / size);
          at = corner;
          gl_Position = projectionMatrix * viewMatrix * links[int(link + 0.5)] * vec4(position, 1.0);
        }`,
      fragmentShader: `varying vec4 reading; varying vec2 at;
        void main() {
          vec3 rest = vec3(0.16, 0.32, 0.30), near = vec3(0.0, 0.45, 0.85), hot = vec3(0.90, 0.42, 0.0);
          vec3 colour = mix(rest, near, clamp(reading.y, 0.0, 1.0));
          colour = mix(colour, hot, clamp(reading.x, 0.0, 1.0));
          if (reading.z > 0.5) colour = vec3(0.62);
          if (reading.w > 0.5) colour = reading.w < 1.5 ? vec3(0.16, 0.62, 0.36) : reading.w < 2.5 ? vec3(0.85, 0.64, 0.0) : reading.w < 3.5 ? vec3(0.85, 0.37, 0.01) : vec3(0.70, 0.07, 0.23);
          if (length(at) > 0.93) colour *= 0.6;
          gl_FragColor = vec4(colour, 1.0);
        }`});
    if (this.mesh) this.scene.remove(this.mesh);
    this.mesh = new T.Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.scene.add(this.mesh);
    this.moved = true;
  }
  tf(list) {
    const T = this.THREE;
    if (this.urdf) this.dress(new Set(list.flatMap(f => [f.child, f.frame])));
    for (const f of list) {
      const m = this.frames.get(f.child) || this.frames.set(f.child, new T.Matrix4()).get(f.child);
      m.compose(new T.Vector3(...f.p), new T.Quaternion(...f.q), new T.Vector3(1, 1, 1));
      const g = this.shapes.get(f.child);
      if (g) g.matrixAutoUpdate = false, g.matrix.copy(m);
    }
    if (!this.aimed && list.length > 0) {  // at the middle of the robot, from where all of it is seen
      this.aimed = true;
      const box = new T.Box3();
      for (const f of list) box.expandByPoint(new T.Vector3(...f.p));
      box.expandByPoint(new T.Vector3());
      const middle = box.getCenter(new T.Vector3()), shape = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
      const far = (0.45 + 1.05 * box.getSize(new T.Vector3()).length()) * Math.max(1, 1 / shape);
      this.controls.target.copy(middle);
      this.camera.position.copy(middle).add(new T.Vector3(0.62, -0.66, 0.42).multiplyScalar(far));
      this.controls.update();
    }
    this.close(list.map(f => f.child));
    (this.links || []).forEach((name, i) => { const m = this.frames.get(name); if (m) this.matrices[i].copy(m); });
    this.moved = true;
  }
  /// Fills the gaps between the tubes of links that follow each other, where these are nearest.
  close(names) {
    const T = this.THREE, tubes = names.filter(n => this.tubes && this.tubes.has(n)).map(n => {
      const t = this.tubes.get(n), X = new T.Matrix4().multiplyMatrices(this.frames.get(n), t.X);
      return {a: t.from.clone().applyMatrix4(X), b: t.to.clone().applyMatrix4(X), r: t.r};
    });
    for (let i = 0; i + 1 < tubes.length; ++i) {
      const [p, q] = nearestOf(tubes[i], tubes[i + 1]), r = 0.9 * Math.min(tubes[i].r, tubes[i + 1].r), way = q.clone().sub(p), far = way.length();
      let joint = this.joints[i];
      if (!joint) {
        joint = this.joints[i] = new T.Mesh(new T.CylinderGeometry(1, 1, 1, 24), new T.MeshLambertMaterial({color: 0x838c96}));
        this.scene.add(joint);
      }
      joint.visible = far > 1e-3;
      if (!joint.visible) continue;
      joint.position.copy(p).add(q).multiplyScalar(0.5), joint.scale.set(r, far, r);
      joint.quaternion.setFromUnitVectors(new T.Vector3(0, 1, 0), way.divideScalar(far));
    }
  }
  /// The cell that is pressed most is fully coloured, from 3 N on; what was pressed harder is forgotten within a second.
  readings(cloud) {
    if (!this.index) return;
    const {view, step, fields, count} = cloud;
    let most = 3;
    for (let i = 0; i < count; ++i) most = Math.max(most, view.getFloat32(i * step + fields.force, true) || 0);
    const full = this.full = Math.max(most, 0.9 * (this.full || 3));
    for (let i = 0; i < count; ++i) {
      const at = i * step, k = this.index.get(view.getUint32(at + fields.cell, true));
      if (k === undefined) continue;
      this.values[4 * k] = Math.sqrt(Math.max(0, view.getFloat32(at + fields.force, true)) / full);  // weak ones beside strong ones
      this.values[4 * k + 1] = view.getFloat32(at + fields.proximity, true);
      this.values[4 * k + 2] = view.getUint32(at + fields.status, true) !== 0 ? 1 : 0;
    }
    this.texture.needsUpdate = true;
    this.moved = true;
  }
  /// Cells in the colours of how well their places feel; null: as they are pressed.
  felt(map) {
    if (!this.index) return;
    for (let k = 0; k < this.cells.length; ++k) this.values[4 * k + 3] = 0;
    if (map) map.cells.forEach((id, i) => {
      const k = this.index.get(id);
      if (k !== undefined) this.values[4 * k + 3] = 1 + feltClass(map.noticed[i]);
    });
    this.texture.needsUpdate = true;
    this.moved = true;
  }
  /// Arrows with their tips on the surface.
  contacts(cloud) {
    const T = this.THREE, {view, step, fields, count} = cloud, get = (i, f) => view.getFloat32(i * step + fields[f], true);
    this.arrows.forEach((arrow, i) => {
      arrow.visible = i < count;
      if (i >= count) return;
      const F = new T.Vector3(get(i, 'fx'), get(i, 'fy'), get(i, 'fz')), n = F.length(), long = 0.06 + 0.006 * Math.min(n, 60);
      const way = n > 0 ? F.clone().multiplyScalar(1 / n) : new T.Vector3(0, 0, -1);
      arrow.position.set(get(i, 'x'), get(i, 'y'), get(i, 'z'));
      arrow.quaternion.setFromUnitVectors(new T.Vector3(0, 1, 0), way);
      arrow.head.position.y = -0.02, arrow.shaft.position.y = -0.03 - long / 2, arrow.shaft.scale.y = long;
    });
    this.moved = true;
  }
  /// Where a place of the picture, [-1, 1] to the right and up, meets the robot: {link, p, n} in the frame of the link, and `at` in
  /// the base's; null: beside it.
  pick(x, y) {
    const T = this.THREE, meshes = [];
    this.ray.setFromCamera({x, y}, this.camera);
    for (const [link, g] of this.shapes) {
      g.updateMatrixWorld(true);
      g.traverse(o => { if (o.isMesh) o.userData.link = link, meshes.push(o); });
    }
    const hit = this.ray.intersectObjects(meshes)[0], frame = hit && this.frames.get(hit.object.userData.link);
    if (!frame) return null;
    const back = new T.Matrix4(), n = hit.face.normal.clone().transformDirection(hit.object.matrixWorld);
    back.invert ? back.copy(frame).invert() : back.getInverse(frame);
    return {link: hit.object.userData.link, p: hit.point.clone().applyMatrix4(back).toArray(), n: n.transformDirection(back).toArray(), at: hit.point};
  }
  /// From `at` to where a place of the picture is in the plane of `at` that faces the camera [m], at most 0.3 m.
  beside(x, y, at) {
    const T = this.THREE, plane = new T.Plane().setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new T.Vector3()), at);
    this.ray.setFromCamera({x, y}, this.camera);
    const there = this.ray.ray.intersectPlane(plane, new T.Vector3());
    return there ? there.sub(at).clampLength(0, 0.3).toArray() : [0, 0, 0];
  }
  /// The finger on a place of a link, as `pick` gives it; `way` before the surface [m]; null: it is gone.
  point(spot, way = 0) {
    const T = this.THREE, frame = spot && this.frames.get(spot.link);
    this.moved = this.moved || this.finger.visible || Boolean(frame);
    this.finger.visible = Boolean(frame);
    if (!frame) return;
    const n = new T.Vector3(...spot.n).transformDirection(frame);
    this.finger.position.set(...spot.p).applyMatrix4(frame).addScaledVector(n, way);
    this.finger.quaternion.setFromUnitVectors(new T.Vector3(0, 1, 0), n);
  }
  /// Draws if anything has moved.
  draw(background) {
    const w = this.canvas.clientWidth, h = this.canvas.clientHeight;
    if (w !== this.w || h !== this.h) {
      this.w = w, this.h = h, this.moved = true;
      this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
      this.renderer.setSize(w, h, false);
      this.camera.aspect = w / Math.max(1, h), this.camera.updateProjectionMatrix();
    }
    if (!this.moved) return;
    this.moved = false;
    this.renderer.setClearColor(background, 1);
    this.renderer.render(this.scene, this.camera);
    this.drawn = (this.drawn || 0) + 1;
  }
}
