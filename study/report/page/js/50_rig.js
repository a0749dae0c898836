// The rig in three dimensions: robot, cameras true and estimated, board, drive, ground, uncertainty.
const vector = (list) => new three.Vector3(list[0], list[1], list[2]);
const poseMatrix = (pose) => new three.Matrix4().compose(vector(pose), new three.Quaternion(pose[3], pose[4], pose[5], pose[6]), new three.Vector3(1, 1, 1));

// Rotation vector of a quaternion, and back.
function rotationVector(q) {
  const sine = Math.hypot(q.x, q.y, q.z);
  if (sine < 1e-15) return new three.Vector3();
  const angle = 2 * Math.atan2(sine, Math.abs(q.w)) * Math.sign(q.w || 1);
  return new three.Vector3(q.x, q.y, q.z).multiplyScalar(angle / sine);
}
function quaternionOf(phi) {
  const angle = phi.length();
  return angle < 1e-15 ? new three.Quaternion() : new three.Quaternion().setFromAxisAngle(phi.clone().divideScalar(angle), angle);
}
// The estimate with its error times k: t + k dt, Exp(k phi) R, in the parent's axes.
function exaggerated(truth, estimate, k) {
  if (!truth) return poseMatrix(estimate);
  const t = vector(truth).addScaledVector(vector(estimate).sub(vector(truth)), k);
  const Q = (pose) => new three.Quaternion(pose[3], pose[4], pose[5], pose[6]);
  const phi = rotationVector(Q(estimate).multiply(Q(truth).invert()));
  return new three.Matrix4().compose(t, quaternionOf(phi.multiplyScalar(k)).multiply(Q(truth)), new three.Vector3(1, 1, 1));
}
// Half axes of x' C^-1 x = 1: Jacobi's rotations on a symmetric 3x3.
function principalAxes(C) {
  const a = [[C[0], C[1], C[2]], [C[3], C[4], C[5]], [C[6], C[7], C[8]]], v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 30; ++sweep) for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
    if (Math.abs(a[p][q]) < 1e-30) continue;
    const theta = 0.5 * Math.atan2(2 * a[p][q], a[q][q] - a[p][p]), c = Math.cos(theta), n = Math.sin(theta);
    for (let k = 0; k < 3; ++k) { const x = a[k][p], y = a[k][q]; a[k][p] = c * x - n * y; a[k][q] = n * x + c * y; }
    for (let k = 0; k < 3; ++k) { const x = a[p][k], y = a[q][k]; a[p][k] = c * x - n * y; a[q][k] = n * x + c * y; }
    for (let k = 0; k < 3; ++k) { const x = v[k][p], y = v[k][q]; v[k][p] = c * x - n * y; v[k][q] = n * x + c * y; }
  }
  return [0, 1, 2].map((i) => ({ half: Math.sqrt(Math.max(0, a[i][i])), direction: new three.Vector3(v[0][i], v[1][i], v[2][i]) }));
}

const lineGeometry = (points) => new three.BufferGeometry().setAttribute("position", new three.Float32BufferAttribute(points.flat(), 3));
const segments = (points, value, options = {}) => new three.LineSegments(lineGeometry(points), new three.LineBasicMaterial({ color: value, ...options }));
function dashed(points, value, dash = 0.05) {
  const line = new three.Line(lineGeometry(points), new three.LineDashedMaterial({ color: value, dashSize: dash, gapSize: dash }));
  line.computeLineDistances();
  return line;
}

function pictureTexture(canvas) {
  const texture = new three.CanvasTexture(canvas);
  texture.colorSpace = "srgb";
  return texture;
}

// Names for labels: without the end that all of them share, and cut where they are still long.
function labelNames(names) {
  const longest = 18, parts = names.map((name) => name.split("_"));
  if (Math.max(...names.map((name) => name.length)) <= longest) return names;
  const shared = (count) => parts.length > 1 && parts.every((own) => own.length > count && own.slice(-count).join() === parts[0].slice(-count).join());
  let count = 0;
  while (shared(count + 1)) ++count;
  return parts.map((own) => shortened(own.slice(0, own.length - count).join("_"), longest));
}

// Of the same height on the screen, near or far.
function labelSprite(text, value, size) {
  const canvas = h("canvas", { height: 96 }), pen = canvas.getContext("2d"), font = "600 56px " + getComputedStyle(document.body).fontFamily;
  pen.font = font;
  canvas.width = Math.ceil(pen.measureText(text).width) + 24;  // which forgets the font
  pen.font = font;
  pen.textBaseline = "middle";
  pen.lineWidth = 12;
  pen.lineJoin = "round";
  pen.strokeStyle = color("card");
  pen.strokeText(text, 12, 50);
  pen.fillStyle = value;
  pen.fillText(text, 12, 50);
  const sprite = new three.Sprite(new three.SpriteMaterial({ map: pictureTexture(canvas), depthTest: false, transparent: true, sizeAttenuation: false }));
  sprite.center.set(0, 0.5);
  sprite.scale.set((size * canvas.width) / 96, size, 1);
  sprite.renderOrder = 5;
  return sprite;
}

function frustum(camera, value, depth, { dash = false, filled = 0 } = {}) {
  const group = new three.Group(), tips = camera.frustum.map(([x, y]) => [x * depth, y * depth, depth]);
  const loop = [...tips, tips[0]];
  if (dash) {
    for (const tip of tips) group.add(dashed([[0, 0, 0], tip], value, 0.02));
    group.add(dashed(loop, value, 0.02));
  } else {
    group.add(segments([...tips.flatMap((tip) => [[0, 0, 0], tip]), ...tips.flatMap((tip, i) => [tip, loop[i + 1]])], value));
    // The image's upper side, so that a camera mounted upside down strikes the eye.
    const [a, b] = tips, up = [(a[0] + b[0]) / 2, a[1] - 0.16 * depth * Math.abs(camera.frustum[0][0]), depth];
    group.add(segments([a, up, up, b], value));
  }
  if (filled) {
    const faces = [[0, 0, 0], tips[0], tips[1], [0, 0, 0], tips[1], tips[2], [0, 0, 0], tips[2], tips[3], [0, 0, 0], tips[3], tips[0]];
    group.add(new three.Mesh(lineGeometry(faces), new three.MeshBasicMaterial({ color: value, transparent: true, opacity: filled, side: three.DoubleSide, depthWrite: false })));
  }
  return group;
}

function ellipsoid(C, value, scale) {
  const axes = principalAxes(C);
  if (axes[0].direction.clone().cross(axes[1].direction).dot(axes[2].direction) < 0) axes[2].direction.negate();
  const mesh = new three.Mesh(new three.SphereGeometry(1, 28, 18), new three.MeshLambertMaterial({ color: value, transparent: true, opacity: 0.38, depthWrite: false }));
  const basis = new three.Matrix4().makeBasis(axes[0].direction, axes[1].direction, axes[2].direction);
  mesh.quaternion.setFromRotationMatrix(basis);
  mesh.scale.set(...axes.map((axis) => Math.max(1e-5, axis.half * scale)));
  return mesh;
}

// No file tells how the robot looks: a box below the cameras with four wheels, forward in its frame.
function robotModel(places, letters) {
  const group = new three.Group(), dull = color("robot");
  const xs = places.map((p) => p[0]), ys = places.map((p) => p[1]), zs = places.map((p) => p[2]);
  const front = Math.max(0.3, ...xs), back = Math.min(-0.3, ...xs.map((x) => x - 0.1)), half = Math.max(0.25, ...ys.map((y) => 0.9 * Math.abs(y)));
  const top = Math.max(0.15, Math.min(0.38, 0.6 * Math.min(...zs, 1))), bottom = 0.2 * top, radius = 0.3 * top;
  const box = new three.BoxGeometry(front - back, 2 * half, top - bottom);
  const body = new three.Mesh(box, new three.MeshLambertMaterial({ color: dull, transparent: true, opacity: 0.82 }));
  const edges = new three.LineSegments(new three.EdgesGeometry(box), new three.LineBasicMaterial({ color: color("soft") }));
  for (const part of [body, edges]) part.position.set((front + back) / 2, 0, (top + bottom) / 2);
  group.add(body, edges);
  for (const x of [back + radius, front - radius]) for (const side of [-1, 1]) {
    const wheel = new three.Mesh(new three.SphereGeometry(1, 24, 16), new three.MeshLambertMaterial({ color: new three.Color(dull).multiplyScalar(0.7) }));
    wheel.scale.set(radius, 0.045, radius);
    wheel.position.set(x, side * (half + 0.045), radius);
    group.add(wheel);
  }
  const inside = (value, low, high) => Math.min(high, Math.max(low, value));
  for (const p of places) if (p[2] > top) group.add(segments([[inside(p[0], back, front), inside(p[1], -half, half), top], [p[0], p[1], p[2]]], color("soft")));
  for (const [axis, value, name] of [[[0.35, 0, 0], "#d6453d", "x"], [[0, 0.35, 0], "#2e9a4f", "y"], [[0, 0, 0.35], "#3b6fd4", "z"]]) {
    group.add(segments([[0, 0, 0], axis], value));
    const label = labelSprite(name, value, letters);
    label.position.set(...axis);
    group.add(label);
  }
  return group;
}

function boardModel(board) {
  const group = new three.Group(), [nx, ny] = board.squares, pixels = 48;
  const canvas = h("canvas", { width: nx * pixels, height: ny * pixels }), pen = canvas.getContext("2d");
  for (let y = 0; y < ny; ++y) for (let x = 0; x < nx; ++x) {
    pen.fillStyle = (x + y) % 2 === 0 ? "#1a1d21" : "#fafafa";
    pen.fillRect(x * pixels, y * pixels, pixels, pixels);
  }
  const [a, b, c, d] = board.outline.map(([x, y]) => [x, y, 0]);
  const geometry = lineGeometry([a, b, c, a, c, d]);
  geometry.setAttribute("uv", new three.Float32BufferAttribute([0, 1, 1, 1, 1, 0, 0, 1, 1, 0, 0, 0], 2));
  group.add(new three.Mesh(geometry, new three.MeshBasicMaterial({ map: pictureTexture(canvas), side: three.DoubleSide })));
  group.add(segments([a, b, b, c, c, d, d, a], color("ink")));
  return group;
}

// `strength`: of the lines, 1 where the drive is what is looked at.
function driveModel(drive, withOdometry, strength) {
  const group = new three.Group(), lift = ([x, y]) => [x, y, 0.004];
  group.add(new three.Line(lineGeometry(drive.driven.map(lift)), new three.LineBasicMaterial({ color: color("soft"), transparent: true, opacity: 0.3 * strength })));
  if (withOdometry) {
    const track = dashed(drive.odometry.map(lift), "#aa3c8c", 0.06);
    Object.assign(track.material, { transparent: true, opacity: 0.7 * strength });
    group.add(track);
  }
  const arrows = drive.driven.flatMap((pose) => {
    const heading = new three.Vector3(0.09, 0, 0).applyQuaternion(new three.Quaternion(...pose.slice(3))), tip = [pose[0] + heading.x, pose[1] + heading.y, 0.004];
    const side = [-heading.y * 0.35, heading.x * 0.35], base = [pose[0], pose[1]];
    return [[base[0] + side[0], base[1] + side[1], 0.004], tip, [base[0] - side[0], base[1] - side[1], 0.004], tip];
  });
  group.add(segments(arrows, color("soft"), { transparent: true, opacity: 0.8 * strength }));
  return group;
}

// One for all methods: a browser has few WebGL contexts.
let rendererOnce = null;
function theRenderer() {
  if (!rendererOnce) {
    rendererOnce = new three.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    rendererOnce.setPixelRatio(Math.min(2, devicePixelRatio || 1));
  }
  return rendererOnce;
}
let lastView = null;

class RigView {
  constructor(data, result, holder) {
    Object.assign(this, { data, result, holder, names: labelNames(data.cameras.map(({ name }) => name)), stop: 0, k: 1, where: "rig", parts: { estimated: true, true: true, uncertainty: true, drive: true, odometry: false, board: true, ground: true } });
    this.renderer = theRenderer();
    this.camera = new three.PerspectiveCamera(38, 1, 0.02, 300);
    this.camera.up.set(0, 0, 1);
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "The rig in three dimensions. Arrow keys turn, plus and minus zoom.");
    holder.append(canvas);
    this.controls = new three.OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.zoomToCursor = true;
    canvas.onkeydown = (event) => this.onkey(event);
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(holder);
    this.build();
    this.look("rig");
  }
  // As the view of another method stands: the same stop, parts and place to look from.
  resume(other) {
    Object.assign(this, { stop: other.stop, parts: other.parts, where: other.where });
    this.camera.aspect = other.camera.aspect;
    this.camera.updateProjectionMatrix();
    this.camera.position.copy(other.camera.position);
    this.controls.target.copy(other.controls.target);
    this.controls.update();
  }
  dispose() {
    this.controls.dispose();
    this.observer.disconnect();
  }
  places() {
    return this.data.cameras.map((camera) => camera.true_pose || (this.result.poses.find((p) => p.child === camera.name) || {}).T).filter(Boolean);
  }
  // Height of a label as sprites have it: 22 pixels, as a share of the view one metre away.
  letters() { return (22 / (this.holder.clientHeight || 500)) * 2 * Math.tan((this.camera.fov * Math.PI) / 360); }
  // Everything again: a few hundred lines.
  build() {
    this.scene = new three.Scene();
    this.labels = [];
    this.scene.background = new three.Color(color("faint"));
    this.scene.add(new three.AmbientLight(0xffffff, 1.6));
    const sun = new three.DirectionalLight(0xffffff, 1.6);
    sun.position.set(-2, -3, 5);
    this.scene.add(sun);
    const { drive } = this.data, here = drive.driven[this.stop];
    if (this.parts.ground) this.addGround();
    if (this.parts.drive && drive.driven.length > 1) this.scene.add(driveModel(drive, this.parts.odometry && drive.is_true, this.driveStrength()));
    const boards = [[this.data.board, drive.board], ...(this.data.more_boards || []).map((board, i) => [board, drive.more_boards[i]])];
    boards.forEach(([board, pose], i) => {
      if (!pose || !this.parts.board) return;
      const model = boardModel(board);
      if (boards.length > 1) model.add(this.boardNumber(board, i + 1));
      model.applyMatrix4(poseMatrix(pose));
      this.scene.add(model);
    });
    const robot = new three.Group();
    if (here) robot.applyMatrix4(poseMatrix(here));
    robot.add(robotModel(this.places(), this.letters()));
    this.data.cameras.forEach((camera, i) => this.addCamera(robot, camera, i));
    this.scene.add(robot);
    this.draw();
  }
  // Beside the rig, the lines of more than a dozen stops would hide what is looked at.
  driveStrength() {
    const isOfRig = this.where === "rig" || this.where === "side" || this.where === "front";
    return isOfRig ? Math.min(1, Math.max(0.25, 12 / this.data.drive.driven.length)) : 1;
  }
  boardNumber(board, number) {
    const label = labelSprite(`board ${number}`, color("ink"), this.letters());
    label.position.set(...board.outline[1], 0);
    return label;
  }
  addGround() {
    const points = [...this.data.drive.driven, ...this.boards()];
    const reach = Math.ceil(Math.max(2, ...points.map((p) => Math.max(Math.abs(p[0]), Math.abs(p[1])))) + 0.5);
    const grid = new three.GridHelper(2 * reach, 2 * reach, color("soft"), color("line"));
    grid.rotation.x = Math.PI / 2;
    this.scene.add(grid);
  }
  addCamera(robot, camera, index) {
    const pose = this.result.poses.find((p) => p.child === camera.name), value = cameraColor(index), depth = 0.3;
    const estimate = pose && (pose.T_estimate || pose.T), truth = camera.true_pose;
    if (this.parts.true && truth) {
      const node = frustum(camera, color("truth"), depth, { dash: true });
      node.applyMatrix4(poseMatrix(truth));
      robot.add(node);
    }
    const shown = this.parts.estimated && estimate ? exaggerated(truth, estimate, this.k) : truth ? poseMatrix(truth) : null;
    if (!shown) return;
    if (this.parts.estimated && estimate) {
      const node = frustum(camera, value, depth, { filled: 0.16 });
      node.applyMatrix4(shown);
      robot.add(node);
    }
    if (this.parts.uncertainty && pose && pose.place_covariance && estimate) {
      const mesh = ellipsoid(pose.place_covariance, value, 2 * this.k);
      mesh.position.setFromMatrixPosition(shown);
      robot.add(mesh);
    }
    const label = labelSprite(this.names[index], value, this.letters());
    label.position.setFromMatrixPosition(shown).add(new three.Vector3(0, 0, 0.09));
    robot.add(label);
    this.labels.push(label);
  }
  // Poses of those that are known.
  boards() {
    return [this.data.drive.board, ...(this.data.drive.more_boards || [])].filter((pose) => pose);
  }

  // From behind and above, with the board in view.
  overTheShoulder(M, board, tall) {
    const robot = new three.Vector3().setFromMatrixPosition(M);
    const ahead = (board ? vector(board) : new three.Vector3(1, 0, 0).applyMatrix4(M)).sub(robot).setZ(0).normalize();
    const side = new three.Vector3(-ahead.y, ahead.x, 0), up = new three.Vector3(0, 0, 1);
    const eye = robot.clone().addScaledVector(ahead, -1.55 * tall).addScaledVector(side, 1.25 * tall).addScaledVector(up, 1.3 * tall);
    return [eye, robot.clone().addScaledVector(ahead, 0.5).addScaledVector(up, 0.38)];
  }
  look(where) {
    const here = this.data.drive.driven[this.stop] || [0, 0, 0, 0, 0, 0, 1], M = poseMatrix(here), board = this.data.drive.board;
    const inRobot = (x, y, z) => new three.Vector3(x, y, z).applyMatrix4(M);
    const all = [...this.data.drive.driven, ...this.boards()];
    const mid = [0, 1].map((i) => (Math.max(...all.map((p) => p[i])) + Math.min(...all.map((p) => p[i]))) / 2);
    const wide = Math.max(1.5, ...all.map((p) => Math.hypot(p[0] - mid[0], p[1] - mid[1])));
    const tall = Math.max(1, 1.5 / (this.camera.aspect || 1));
    const [eye, target] = {
      rig: () => this.overTheShoulder(M, board, tall),
      all: () => [new three.Vector3(mid[0] - 1.1 * wide * tall, mid[1] - 1.9 * wide * tall, 1.6 * wide * tall), new three.Vector3(mid[0], mid[1], 0)],
      top: () => [new three.Vector3(mid[0], mid[1] - 0.01, 3.6 * wide * tall), new three.Vector3(mid[0], mid[1], 0)],
      side: () => [inRobot(0.15, -2.6 * tall, 0.5), inRobot(0.15, 0, 0.45)],
      front: () => [inRobot(3 * tall, 0, 0.6), inRobot(0, 0, 0.45)],
    }[where]();
    this.camera.position.copy(eye);
    this.controls.target.copy(target);
    this.controls.update();
    this.where = where;
    this.build();
  }
  onkey(event) {
    const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const offset = this.camera.position.clone().sub(this.controls.target);
    if (turn) {
      offset.applyAxisAngle(new three.Vector3(0, 0, 1), turn[0] * 0.12);
      const side = new three.Vector3().crossVectors(offset, this.camera.up).normalize();
      const tilted = offset.clone().applyAxisAngle(side, -turn[1] * 0.1);
      if (Math.abs(tilted.z) < 0.995 * tilted.length()) offset.copy(tilted);
    } else if (event.key === "+" || event.key === "=") offset.multiplyScalar(0.87);
    else if (event.key === "-") offset.multiplyScalar(1.15);
    else return;
    event.preventDefault();
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }
  resize() {
    const { clientWidth, clientHeight } = this.holder;
    if (!clientWidth || !clientHeight) return;
    const first = this.camera.aspect === 1;
    this.fit();
    if (first) this.look(this.where);
    this.build();
  }
  // To its place, which paper makes another one and the screen the old one again, without telling.
  fit() {
    const { clientWidth, clientHeight } = this.holder, { domElement } = this.renderer, ratio = this.renderer.getPixelRatio();
    const isSame = domElement.width === Math.floor(clientWidth * ratio) && domElement.height === Math.floor(clientHeight * ratio);
    if (!clientWidth || !clientHeight || (isSame && this.camera.aspect === clientWidth / clientHeight)) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
  }
  // Labels rise until none hides another, the lowest first.
  spreadLabels() {
    this.scene.updateMatrixWorld();
    this.camera.updateMatrixWorld();
    const half = Math.tan((this.camera.fov * Math.PI) / 360), taken = [];
    const placed = this.labels.map((label) => ({ label, ...label.getWorldPosition(new three.Vector3()).project(this.camera) })).sort((a, b) => a.y - b.y);
    for (const { label, x, y } of placed) {
      const width = label.scale.x / (half * this.camera.aspect), height = (0.8 * label.scale.y) / half;
      const isHidden = (at) => taken.some((other) => x < other.right && other.left < x + width && Math.abs(at - other.at) < height);
      let rise = 0;
      while (isHidden(y + rise * height)) ++rise;
      label.center.y = 0.5 - 0.8 * rise;
      taken.push({ left: x, right: x + width, at: y + rise * height });
    }
  }
  render() {
    this.fit();
    this.spreadLabels();
    this.renderer.render(this.scene, this.camera);
  }
  // No frame comes before the paper, and browsers print the last one: a copy is printed instead.
  drawOnPaper() {
    const { domElement } = this.renderer;
    this.render();
    if (!this.paper) this.holder.append((this.paper = h("canvas", { class: "paper", "aria-hidden": "true" })));
    this.paper.width = domElement.width;
    this.paper.height = domElement.height;
    this.paper.getContext("2d").drawImage(domElement, 0, 0);
  }
  draw() {
    if (isPrinted()) return this.drawOnPaper();
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => { this.waiting = 0; this.render(); });
  }
}

// So that the largest error, or else 2 sigma, is about as long as a camera is wide.
function firstExaggeration(data, result) {
  let largest = 0;
  for (const pose of result.poses) {
    const lengths = pose.error || pose.sigma;
    if (lengths) lengths.slice(0, 3).forEach((value, i) => { if (pose.observable[i]) largest = Math.max(largest, Math.abs(value || 0) * (pose.error ? 1 : 2)); });
  }
  return largest > 0 ? Math.min(3, Math.max(0, Math.log10(0.08 / largest))) : 0;
}

function rigSection(data, result) {
  const holder = h("div", { id: "view3d" });
  const unknown = data.cameras.filter(({ name }) => !result.poses.some((pose) => pose.child === name && (pose.T_estimate || pose.T))).map(({ name }) => name);
  const part = section("rig", "The rig", data.has_truth
    ? "Coloured: estimated; dashed: true. Errors and the 2-sigma ellipsoids of the camera centres are drawn larger than they are. The robot's body is schematic; the frusta tell which way is up."
    : "Cameras as estimated, with the 2-sigma ellipsoids of their centres drawn larger than they are. The robot's body is schematic; the frusta tell which way is up.",
  h("div", { class: "card" }, holder, unknown.length ? h("p", { class: "small soft", style: { marginTop: "10px" } }, `Not drawn, because their poses are not answered completely: ${unknown.join(", ")}.`) : null));
  let view;
  if (lastView) lastView.dispose();
  try {
    view = new RigView(data, result, holder);
    if (lastView) view.resume(lastView);
    lastView = view;
  } catch (problem) {
    replace(holder, h("div", { class: "none" }, "This browser draws no WebGL: the picture is left out."));
    return part;
  }
  const start = firstExaggeration(data, result), told = h("output", { for: "exaggeration" });
  const slider = h("input", { type: "range", id: "exaggeration", min: 0, max: 3, step: 0.05, value: start.toFixed(2) });
  const stretch = () => {
    view.k = 10 ** Number(slider.value);
    told.textContent = "\u00d7" + (view.k < 10 ? figure(view.k) : Math.round(view.k));
    view.build();
  };
  slider.addEventListener("input", stretch);
  const stops = data.drive.driven.length, at = h("output", {}, String(view.stop));
  const stopSlider = h("input", { type: "range", id: "stop", min: 0, max: Math.max(0, stops - 1), value: view.stop, oninput: () => {
    view.stop = Number(stopSlider.value);
    at.textContent = stopSlider.value;
    view.build();
    if (view.where === "rig" || view.where === "side" || view.where === "front") view.look(view.where);
  } });
  const toggles = [["estimated", "estimated"], ["true", "true"], ["uncertainty", "2 sigma"], ["drive", "drive"], ["odometry", "odometry"], ["board", "board"], ["ground", "ground"]]
    .filter(([key]) => (key !== "true" && key !== "odometry") || data.has_truth)
    .map(([key, name]) => checkbox(name, view.parts[key], (on) => { view.parts[key] = on; view.build(); }));
  const views = [["rig", "rig"], ["all", "drive"], ["top", "top"], ["side", "side"], ["front", "front"]]
    .map(([key, name]) => h("button", { type: "button", onclick: () => view.look(key) }, name));
  holder.before(
    h("div", { class: "bar" }, h("span", { class: "copy" }, h("span", { class: "soft" }, "look at"), views),
      h("label", {}, "errors and sigmas", slider, told), stops > 1 ? h("label", {}, "stop", stopSlider, at) : null),
    h("div", { class: "bar", style: { marginTop: "8px", marginBottom: "12px" } }, toggles));
  whenShown(stretch);
  return part;
}
