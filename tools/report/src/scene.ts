// The robots in 3D: the run, and the golden as a ghost. Drawn only after a change.
import * as three from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { absence, element, set_text } from './dom';
import { Figure, Meshes } from './figure';
import { Kinematics, series_of } from './kinematics';
import type { Report } from './report';
import type { Store } from './store';
import { is_dark, palette } from './theme';

const not_moved = 1e-6; // distance of a link from the golden's that the picture doesn't show [m]

/** The most that the camera moves away for the rest of a run, as a factor: the robot stays large. */
const farthest = 1.25;

export class Scene {
  readonly root = element('div', { class: 'scene' });
  /** How far run and golden are apart; for the head of the panel. */
  readonly note = element('span', { class: 'note' });
  private renderer: three.WebGLRenderer | null = null;
  private readonly scene = new three.Scene();
  private readonly camera = new three.PerspectiveCamera(30, 1, 0.01, 500);
  private controls: OrbitControls | null = null;
  private grid: three.GridHelper | null = null;
  private readonly ghost_material = new three.MeshLambertMaterial({
    transparent: true,
    opacity: 0.35,
    depthWrite: false,
    polygonOffset: true, // surfaces of the run hide equal ones of the ghost
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 4,
  });
  private readonly figures: Figure[] = [];
  private readonly ghosts: (Figure | null)[] = [];
  private readonly followed = new three.Vector3();
  private main: Figure | undefined;
  private slow = false;
  private moved_by_hand = false;
  private size = 1; // of what the camera was fitted to [m]
  private size_of_note: [number, number] | null = null; // [pixels]; null: to be measured
  follow = true;
  drawings = 0;

  constructor(
    private readonly store: Store,
    private readonly report: Report,
  ) {
    if (report.data.robots.length === 0) return;
    try {
      this.renderer = new three.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: false });
    } catch {
      this.root.append(absence('This browser has no WebGL, without which the robot can’t be drawn.'));
    }
    this.scene.add(new three.HemisphereLight(0xffffff, 0x9a9aa0, 2.2));
    const sun = new three.DirectionalLight(0xffffff, 1.6);
    sun.position.set(2, -3, 5);
    this.scene.add(sun);
    this.camera.up.set(0, 0, 1);
    if (this.renderer) this.attach(this.renderer);
  }

  private attach(renderer: three.WebGLRenderer) {
    const { canvas } = renderer.getContext() as WebGL2RenderingContext & { canvas: HTMLCanvasElement };
    canvas.tabIndex = -1;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'the robot in 3D at the cursor; drag to orbit, wheel to come closer');
    this.root.append(canvas);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.store.changed('ghost'));
    this.controls.addEventListener('start', () => (this.moved_by_hand = true));
    new ResizeObserver(() => this.resize()).observe(this.root);
    this.store.on(['tick', 'data'], () => this.update());
    this.store.on(['theme'], () => this.color());
    this.store.on(['tick', 'data', 'theme', 'ghost'], () => this.draw());
  }

  /** Decodes poses, joints and meshes, and looks at what moves. */
  async load() {
    const { robots, meshes: entries } = this.report.data;
    const meshes = new Meshes(entries ?? []);
    await Promise.all(
      robots.map(async (robot, i) => {
        const figure = new Figure(robot, new Kinematics(robot, 'actual'), null);
        await Promise.all([figure.kinematics.load(this.report), figure.load(meshes)]);
        this.figures[i] = figure;
        this.ghosts[i] = null;
        if (this.report.compared && series_of(robot).length > 0) {
          const ghost = new Figure(robot, new Kinematics(robot, 'golden'), this.ghost_material);
          await Promise.all([ghost.kinematics.load(this.report), ghost.load(meshes)]);
          this.ghosts[i] = ghost;
        }
      }),
    );
    for (const figure of [...this.figures, ...this.ghosts]) if (figure?.kinematics.present) this.scene.add(figure.root);
    this.main = this.find_main();
    this.color();
    this.update();
    this.look();
    this.store.changed('data');
  }

  private does_move(figure: Figure): boolean {
    return series_of(figure.robot).some((name) => {
      const range = this.report.find(name)?.entry.range;
      return range ? range[0] !== range[1] : false;
    });
  }

  /** Whom one looks at: of those that move the one with most links; of none, likewise. */
  private find_main(): Figure | undefined {
    const moving = this.figures.filter((figure) => this.does_move(figure));
    return [...(moving.length > 0 ? moving : this.figures)].sort(
      (a, b) => b.robot.links.length - a.robot.links.length,
    )[0];
  }

  /** The main figure, and figures that move beside it and aren't much larger. */
  private figures_to_look_at(): Figure[] {
    const { main } = this;
    if (!main) return [];
    const box = new three.Box3().setFromObject(main.root);
    const size = box.getSize(new three.Vector3()).length();
    const chosen = [main];
    const ghosts = this.ghosts.filter((ghost): ghost is Figure => ghost?.kinematics.present ?? false);
    for (const figure of [...this.figures, ...ghosts]) {
      if (figure === main || !this.does_move(figure)) continue;
      const both = new three.Box3().setFromObject(figure.root).union(box);
      if (both.getSize(new three.Vector3()).length() >= 1.5 * size) continue;
      box.copy(both);
      chosen.push(figure);
    }
    return chosen;
  }

  /** From the front left, as close as the figures fit into the view, now and later in the run. */
  look() {
    if (!this.controls || this.figures.length === 0) return;
    this.moved_by_hand = false;
    this.scene.updateMatrixWorld(true);
    let points = this.figures_to_look_at().flatMap((figure) => figure.corners());
    if (points.length === 0) points = [new three.Vector3(-1, -1, 0), new three.Vector3(1, 1, 1)];
    const box = new three.Box3().setFromPoints(points);
    this.size = Math.max(0.1, box.getSize(new three.Vector3()).length());
    const away = new three.Vector3(0.75, -0.62, 0.32).normalize();
    const field = this.camera.fov * (Math.PI / 180);
    const now = fitted(points, away, field, this.camera.aspect);
    const run = fitted([...points, ...this.points_of_run()], away, field, this.camera.aspect);
    const target = this.follow ? run.target : now.target;
    const nearest = now.position.distanceTo(now.target);
    const distance = this.follow ? Math.min(run.position.distanceTo(run.target), farthest * nearest) : nearest;
    this.camera.position.copy(target).addScaledVector(away, distance);
    this.camera.near = this.size / 50;
    this.camera.far = this.size * 200;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(target);
    this.controls.update();
    this.followed.copy(this.followed_point());
    this.make_grid(this.size / 2);
  }

  /** The corners of the main figure at ticks all over the run, moved as the camera that follows it sees them. */
  private points_of_run(): three.Vector3[] {
    const { main } = this;
    if (!main) return [];
    const samples = 16;
    const { begin } = this.report.data,
      { last } = this.report;
    const here = this.followed_point();
    const points: three.Vector3[] = [];
    const pose = (tick: number) => {
      main.kinematics.update(tick);
      main.update();
      main.root.updateMatrixWorld(true);
    };
    for (let i = 0; i <= samples; ++i) {
      pose(Math.round(begin + ((last - begin) * i) / samples));
      const by = this.followed_point().sub(here);
      by.z -= this.slack(by.z);
      points.push(...main.corners().map((corner) => corner.sub(by)));
    }
    pose(this.store.tick);
    return points;
  }

  /** The part of a rise that the camera doesn't follow: a step doesn't move the picture up and down, a fall does. */
  private slack(rise: number): number {
    const most = 0.15 * this.size;
    return Math.min(Math.max(rise, -most), most);
  }

  // If the recording contains a floor, no grid is needed.
  private make_grid(radius: number) {
    if (this.figures.some((figure) => !this.does_move(figure) && figure !== this.main)) return;
    if (this.grid) {
      this.scene.remove(this.grid);
      this.grid.dispose();
    }
    const cell = 10 ** Math.round(Math.log10(radius / 2));
    const line = new three.Color(palette().line);
    this.grid = new three.GridHelper(cell * 40, 40, line, line);
    this.grid.rotateX(Math.PI / 2);
    this.grid.position.set(
      Math.round(this.followed.x / cell) * cell,
      Math.round(this.followed.y / cell) * cell,
      -0.001 * cell,
    );
    this.scene.add(this.grid);
  }

  private color() {
    const colors = palette();
    this.ghost_material.color.set(colors.golden);
    this.ghost_material.opacity = is_dark() ? 0.4 : 0.35;
    if (this.grid)
      ((this.grid.material as three.LineBasicMaterial).color.set(colors.line),
        this.make_grid(this.controls!.target.distanceTo(this.camera.position) / 3));
  }

  private followed_point(): three.Vector3 {
    const figure = this.main;
    return figure ? new three.Vector3().setFromMatrixPosition(figure.kinematics.links[0]!) : new three.Vector3();
  }

  private update() {
    const { tick } = this.store;
    const notes: string[] = [];
    this.figures.forEach((figure, i) => {
      figure.kinematics.update(tick);
      figure.update();
      const ghost = this.ghosts[i];
      if (!ghost?.kinematics.present) return;
      ghost.kinematics.update(tick);
      ghost.update();
      const { distance, link } = ghost.hide_common_links(figure.kinematics);
      if (distance > not_moved) notes.push(`${link} ${length_text(distance)} from the golden`);
    });
    const note =
      notes.join('; ') || (this.report.compared && this.report.ticks > 0 ? 'links within 1 µm of the golden' : '');
    if (this.note.title !== note) this.note.title = note;
    set_text(this.note, note);
    this.size_of_note = null;
    if (this.follow && this.controls) {
      const point = this.followed_point(),
        by = point.clone().sub(this.followed);
      by.z -= this.slack(by.z);
      if (by.lengthSq() > 0) {
        this.followed.add(by);
        this.camera.position.add(by);
        this.controls.target.add(by);
      }
    }
  }

  private resize() {
    const { clientWidth: width, clientHeight: height } = this.root;
    if (!this.renderer || width === 0 || height === 0) return;
    this.renderer.setPixelRatio(this.slow ? 1 : Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (!this.moved_by_hand) this.look();
    this.draw();
  }

  /** The box around the main figure in the view, from -1 to 1; null: none is drawn. */
  private main_box(): three.Box3 | null {
    if (!this.main || !this.renderer) return null;
    this.camera.updateMatrixWorld();
    this.scene.updateMatrixWorld(true);
    return new three.Box3().setFromPoints(this.main.corners().map((corner) => corner.project(this.camera)));
  }

  /** The main figure in the view: its height [pixels], and its centre from -1 to 1; null: none is drawn. */
  main_on_screen(): { height: number; centre: [number, number]; left: number; top: number } | null {
    const box = this.main_box();
    if (!box) return null;
    const centre = box.getCenter(new three.Vector3());
    const { clientWidth: width, clientHeight: height } = this.root;
    return {
      height: ((box.max.y - box.min.y) / 2) * height,
      centre: [centre.x, centre.y],
      left: ((box.min.x + 1) / 2) * width,
      top: ((1 - box.max.y) / 2) * height,
    };
  }

  /** Puts the note into the first corner in which it doesn't cover the main figure; it stays where it covers nothing. */
  private move_note_aside() {
    const box = this.main_box();
    if (!box || this.note.textContent === '') return;
    this.size_of_note ??= [this.note.offsetWidth, this.note.offsetHeight];
    const { clientWidth: width, clientHeight: height } = this.root;
    const across = (2 * (this.size_of_note[0] + 8)) / Math.max(1, width),
      up = (2 * (this.size_of_note[1] + 6)) / Math.max(1, height);
    const is_free = (corner: string) => {
      const is_beside = corner.endsWith('left') ? box.min.x > across - 1 : box.max.x < 1 - across;
      return is_beside || (corner.startsWith('top') ? box.max.y < 1 - up : box.min.y > up - 1);
    };
    const now = this.note.dataset.corner ?? 'top-left';
    if (!is_free(now)) this.note.dataset.corner = ['top-left', 'bottom-left', 'bottom-right'].find(is_free) ?? now;
  }

  private draw() {
    if (!this.renderer || this.figures.length === 0) return;
    for (const ghost of this.ghosts) if (ghost) ghost.root.visible = this.store.ghost;
    const begin = performance.now();
    this.renderer.render(this.scene, this.camera);
    ++this.drawings;
    this.move_note_aside();
    // software rendering without a graphics card: use fewer pixels
    if (!this.slow && this.drawings > 3 && performance.now() - begin > 25 && window.devicePixelRatio > 1) {
      this.slow = true;
      this.resize();
    }
  }

  /** Joint displacements and root pose as drawn, by robot. */
  joints(side: 'actual' | 'golden' = 'actual'): Record<string, number> {
    const joints: Record<string, number> = {};
    for (const figure of side === 'actual' ? this.figures : this.ghosts)
      Object.assign(joints, figure?.kinematics.joints);
    return joints;
  }

  /** Origins of all links as drawn [m], by ROBOT/LINK. */
  links(): Record<string, [number, number, number]> {
    const links: Record<string, [number, number, number]> = {};
    for (const figure of this.figures) {
      figure.robot.links.forEach((link, i) => {
        const { elements } = figure.kinematics.links[i]!;
        links[`${figure.robot.name}/${link.name}`] = [elements[12]!, elements[13]!, elements[14]!];
      });
    }
    return links;
  }
}

/** The nearest position from which all points fit into the picture, seen in the direction opposite to `away`, and the
 * point to look at. `field`: vertical opening angle [rad]; `aspect`: width of the picture over its height. */
function fitted(points: three.Vector3[], away: three.Vector3, field: number, aspect: number) {
  const margin = 0.93;
  const right = new three.Vector3(0, 0, 1).cross(away).normalize(),
    up = away.clone().cross(right);
  // A point p is in the picture if |(p - position)·axis| <= tangent · (depth of p), for both axes of the picture.
  const span = (axis: three.Vector3, tangent: number) => {
    const high = Math.max(...points.map((point) => point.dot(axis) + tangent * point.dot(away)));
    const low = Math.max(...points.map((point) => -point.dot(axis) + tangent * point.dot(away)));
    return { distance: (high + low) / (2 * tangent), centre: (high - low) / 2 };
  };
  const tangent = Math.tan(field / 2) * margin;
  const across = span(right, tangent * aspect),
    along = span(up, tangent);
  const distance = Math.max(across.distance, along.distance);
  const middle = points.reduce((sum, point) => sum + point.dot(away), 0) / points.length;
  const at = (depth: number) =>
    new three.Vector3()
      .addScaledVector(right, across.centre)
      .addScaledVector(up, along.centre)
      .addScaledVector(away, depth);
  return { position: at(distance), target: at(middle) };
}

function length_text(length: number): string {
  if (length >= 1) return `${length.toFixed(2)} m`;
  if (length >= 1e-3) return `${(length * 1e3).toFixed(length >= 0.1 ? 0 : 1)} mm`;
  return `${(length * 1e6).toFixed(0)} µm`;
}
