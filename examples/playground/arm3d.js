// The arm in three dimensions: links, cells coloured by what they feel, the finger, and the rigid arm as a shadow.
import * as THREE from 'three';
import {OrbitControls} from 'three-orbit';

const vector = a => new THREE.Vector3(a[0], a[1], a[2]);
/// Housings of the joints, in the frames of the links: radius, ends [m].
const housings = [[0, 0.062, [0, 0, -0.01], [0, 0, 0.03]], [1, 0.056, [0, 0, 0.06], [0, 0, 0.2]], [1, 0.048, [-0.36, 0, 0.13585], [-0.425, 0, 0.13585]],
  [2, 0.049, [0, 0, -0.035], [0, 0, 0.19]], [2, 0.037, [-0.34, 0, 0.0165], [-0.39225, 0, 0.0165]], [3, 0.042, [0, 0, -0.035], [0, 0, 0.15]],
  [4, 0.042, [0, 0, -0.04], [0, 0, 0.135]], [5, 0.036, [0, 0, -0.03], [0, 0, 0.08]]];

export class ArmView {
  constructor(canvas) {
    const context = canvas.getContext('webgl2', {antialias: true});
    if (!context) throw new Error('this browser has no WebGL 2');
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({canvas, context, antialias: true});
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(36, 1, 0.05, 20);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-0.85, -1.5, 0.82);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(-0.3, -0.08, 0.27);
    this.controls.enableKeys = false;
    this.controls.minDistance = 0.6, this.controls.maxDistance = 4;
    this.controls.update();
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x9a9fa8, 0.75));
    const sun = new THREE.DirectionalLight(0xffffff, 0.35);
    sun.position.set(-1, -2, 3);
    this.scene.add(sun);
    this.body = new THREE.MeshLambertMaterial();
    this.shadow = new THREE.MeshLambertMaterial({transparent: true, opacity: 0.16, depthWrite: false});
    this.tip = new THREE.MeshLambertMaterial();
    this.finger = new THREE.Group();
    const round = new THREE.Mesh(new THREE.SphereBufferGeometry(0.011, 20, 12), this.tip);
    const shaft = new THREE.Mesh(new THREE.CylinderBufferGeometry(0.018, 0.011, 0.13, 20), this.tip);
    round.position.y = 0.011, shaft.position.y = 0.076;
    this.finger.add(round, shaft);
    this.ring = new THREE.Mesh(new THREE.RingBufferGeometry(0.016, 0.021, 32), new THREE.MeshBasicMaterial({side: THREE.DoubleSide}));
    this.ring.visible = false;
    this.floor = new THREE.GridHelper(2, 20);
    this.floor.rotation.x = Math.PI / 2;
    this.scene.add(this.finger, this.ring, this.floor);
    this.ray = new THREE.Raycaster();
    this.colours();
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.colours());
  }
  /// Draws another robot: the tubes and cells of its links, and of a UR5 its housings.
  robot(tubes, cells, own) {
    for (const g of [...this.links || [], ...this.shadows || []]) this.scene.remove(g);
    this.links = tubes.map(() => this.group()), this.shadows = tubes.map(() => this.group());
    tubes.forEach(([r, ...ends], i) => { if (r > 0) this.part(i, r - 0.003, ends.slice(0, 3), ends.slice(3)); });
    if (own) tubes.forEach(([r], i) => this.ball(i, 0.9 * (r || Math.min(...tubes.map(t => t[0] || 1)))));
    else for (const [link, r, from, to] of housings) this.part(link, r, from, to);
    this.cells = cells;
    this.skin = this.links.map((group, i) => this.patch(group, i));
  }
  /// Seen from where a UR5 is, as far away as the robot is large.
  look(links) {
    const far = Math.max(0.5, ...[0, 1, 2, 3, 4, 5].map(i => Math.hypot(...links.slice(12 * i + 9, 12 * i + 12))));
    const middle = new THREE.Vector3(links[69], links[70], links[71]).multiplyScalar(0.5);
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).add(new THREE.Vector3(-0.55, -1.42, 0.55).multiplyScalar(1.35 * far));
    this.controls.maxDistance = 6 * far;
    this.controls.update();
    // It stands on the floor.
    this.scene.remove(this.stand);
    const foot = new THREE.Vector3(links[9], links[10], links[11]), length = foot.length();
    this.stand = new THREE.Mesh(new THREE.CylinderBufferGeometry(0.06, 0.085, Math.max(0.01, length), 40), this.body);
    this.stand.position.copy(foot).multiplyScalar(0.5), this.stand.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), foot.normalize());
    this.scene.add(this.stand);
  }
  group() {
    const g = new THREE.Group();
    g.matrixAutoUpdate = false;
    this.scene.add(g);
    return g;
  }
  part(link, radius, from, to) {
    const a = vector(from), b = vector(to), length = a.distanceTo(b);
    const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), b.clone().sub(a).normalize());
    this.add(link, new THREE.CylinderBufferGeometry(radius, radius, length, 40), a.add(b).multiplyScalar(0.5), turn);
  }
  /// The housing of a joint.
  ball(link, radius) { this.add(link, new THREE.SphereBufferGeometry(radius, 28, 18), new THREE.Vector3(), new THREE.Quaternion()); }
  add(link, shape, at, turn) {
    for (const [groups, material] of [[this.links, this.body], [this.shadows, this.shadow]]) {
      const mesh = new THREE.Mesh(shape, material);
      mesh.position.copy(at), mesh.quaternion.copy(turn), mesh.userData.link = link;
      groups[link].add(mesh);
    }
  }
  /// The cells of a link as one mesh of hexagons, coloured by vertex.
  patch(group, link) {
    const of = [], points = [], faces = [], normals = [];
    this.cells.forEach((c, i) => {
      if (c.link !== link) return;
      const n = vector(c.n), x = new THREE.Vector3(0, 0, 1).projectOnPlane(n);
      if (x.length() < 0.1) x.set(1, 0, 0).projectOnPlane(n);
      x.normalize();
      const y = n.clone().cross(x), at = vector(c.p).addScaledVector(n, 0.001), first = points.length / 3;
      for (let k = -1; k < 6; ++k) {
        const p = at.clone();
        if (k >= 0) p.addScaledVector(x, 0.0128 * Math.cos(k * Math.PI / 3)).addScaledVector(y, 0.0128 * Math.sin(k * Math.PI / 3));
        points.push(p.x, p.y, p.z), normals.push(n.x, n.y, n.z);
        if (k >= 0) faces.push(first, first + 1 + k, first + 1 + (k + 1) % 6);
      }
      of.push(i);
    });
    const shape = new THREE.BufferGeometry();
    shape.setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
    shape.setAttribute('normal', new THREE.Float32BufferAttribute(normals, 3));
    shape.setAttribute('color', new THREE.Float32BufferAttribute(new Array(points.length).fill(1), 3));
    shape.setIndex(faces);
    group.add(new THREE.Mesh(shape, new THREE.MeshLambertMaterial({vertexColors: THREE.VertexColors})));
    return {of, colour: shape.attributes.color};
  }
  colours() {
    const style = getComputedStyle(document.documentElement), get = k => new THREE.Color(style.getPropertyValue('--' + k).trim());
    this.paint = {rest: get('cell'), pressed: get('pressed'), hard: get('bad'), dead: get('dead'), body: get('link')};
    this.body.color.copy(get('link')), this.shadow.color.copy(get('bad')), this.tip.color.copy(get('good'));
    this.ring.material.color.copy(get('ink'));
    this.scene.background = get('card');
    this.floor.material.vertexColors = THREE.NoColors, this.floor.material.color.copy(get('line')), this.floor.material.needsUpdate = true;
  }
  /// @param feels  whether the cells are what the arm feels by.
  show(v, feels, chosen) {
    const place = (groups, all) => groups.forEach((g, i) => {
      const m = all.subarray(12 * i, 12 * i + 12);
      g.matrix.set(m[0], m[3], m[6], m[9], m[1], m[4], m[7], m[10], m[2], m[5], m[8], m[11], 0, 0, 0, 1);
    });
    place(this.links, v.links), place(this.shadows, v.rigid_links);
    const apart = Math.max(...v.q.map((q, i) => Math.abs(q - v.rigid_q[i])));
    for (const g of this.shadows) g.visible = apart > 0.01;
    const c = new THREE.Color();
    for (const {of, colour} of this.skin) {
      of.forEach((cell, k) => {
        const force = v.reading[cell];
        c.copy(feels ? this.paint.rest : this.paint.body);
        if (feels && v.mask[cell] > 0) c.copy(this.paint.dead);
        else if (feels && force > 0.5) c.copy(this.paint.pressed).lerp(this.paint.hard, Math.min(1, force / 25));
        for (let p = 0; p < 7; ++p) colour.setXYZ(7 * k + p, c.r, c.g, c.b);
      });
      colour.needsUpdate = true;
    }
    this.finger.visible = v.touching > 0;
    const out = vector(v.direction);
    if (out.length() > 0.5) this.finger.position.copy(vector(v.tip)), this.finger.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), out);
    this.ring.visible = chosen >= 0;
    if (chosen >= 0) {
      const {p, n} = this.world(chosen);
      this.ring.position.copy(p).addScaledVector(n, 0.003), this.ring.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), n);
    }
    this.resize();
    this.renderer.render(this.scene, this.camera);
  }
  resize() {
    const {clientWidth: w, clientHeight: h} = this.canvas, ratio = Math.min(2, devicePixelRatio);
    if (this.size === `${w} ${h} ${ratio}`) return;
    this.size = `${w} ${h} ${ratio}`;
    this.renderer.setPixelRatio(ratio), this.renderer.setSize(w, h, false);
    this.camera.aspect = w / Math.max(1, h);
    this.camera.fov = this.camera.aspect < 1 ? 36 / Math.max(0.55, this.camera.aspect) : 36;  // the whole arm on a phone
    this.camera.updateProjectionMatrix();
  }
  world(cell) {
    const c = this.cells[cell], X = this.links[c.link].matrix;
    return {p: vector(c.p).applyMatrix4(X), n: vector(c.n).transformDirection(X)};
  }
  /// On the page, in units of the canvas [-1, 1].
  project(p) { return p.clone().project(this.camera); }
  pointer(event) {
    const box = this.canvas.getBoundingClientRect();
    this.ray.setFromCamera({x: 2 * (event.clientX - box.left) / box.width - 1, y: 1 - 2 * (event.clientY - box.top) / box.height}, this.camera);
  }
  /// Where the pointer meets the arm: {link, p, n} in the frame of the link, and `at` in the base's; null: beside it.
  pick(event) {
    this.pointer(event);
    const meshes = this.links.flatMap(g => g.children.filter(m => 'link' in m.userData));
    this.links.forEach(g => g.updateMatrixWorld(true));
    const hit = this.ray.intersectObjects(meshes)[0];
    if (!hit) return null;
    const link = hit.object.userData.link, back = new THREE.Matrix4().getInverse(this.links[link].matrix);
    const n = hit.face.normal.clone().transformDirection(hit.object.matrixWorld).transformDirection(back);
    return {link, p: hit.point.clone().applyMatrix4(back).toArray(), n: n.toArray(), at: hit.point};
  }
  /// Where the pointer is in the plane of `at` that faces the camera.
  plane(event, at) {
    this.pointer(event);
    const n = this.camera.getWorldDirection(new THREE.Vector3()), out = new THREE.Vector3();
    return this.ray.ray.intersectPlane(new THREE.Plane().setFromNormalAndCoplanarPoint(n, at), out) || at.clone();
  }
  /// The cell towards which an arrow key points from `from`: among those that face the camera.
  next(from, dx, dy) {
    const seen = i => {
      const {p, n} = this.world(i);
      return n.dot(this.camera.position.clone().sub(p).normalize()) > 0.25 ? this.project(p) : null;
    };
    const here = this.project(this.world(from).p), ratio = this.camera.aspect;
    let best = from, least = Infinity;
    this.cells.forEach((_, i) => {
      const at = i === from ? null : seen(i);
      if (!at) return;
      const x = (at.x - here.x) * ratio, y = at.y - here.y, along = x * dx + y * dy, beside = Math.abs(x * dy - y * dx);
      if (along > 0.005 && along + 2.5 * beside < least) best = i, least = along + 2.5 * beside;
    });
    return best;
  }
}
