// Poses of a robot's links: from the root pose and joint displacements of a run at a tick, along the chain from parents
// to children.
import { Matrix4, Quaternion, Vector3 } from 'three';
import type { LinkEntry, PoseEntry, RobotEntry } from './format';
import type { Columns, Report, Values } from './report';

export type Side = 'actual' | 'golden';

export function matrix_of(pose: PoseEntry, into = new Matrix4()): Matrix4 {
  const [x, y, z, qx, qy, qz, qw] = pose;
  return into.compose(new Vector3(x, y, z), new Quaternion(qx, qy, qz, qw).normalize(), new Vector3(1, 1, 1));
}

/** The names of the series that move it. */
export function series_of(robot: RobotEntry): string[] {
  return robot.links.flatMap((link) => [...(link.pose ?? []), ...(link.joint?.q ? [link.joint.q] : [])]);
}

export class Kinematics {
  /** Of each link, in the world. */
  readonly links: Matrix4[];
  /** As they were last set, by the names of their series. */
  readonly joints: Record<string, number> = {};
  /** The robot is in the recording of that run. */
  present = false;
  private readonly offsets: Matrix4[];
  private readonly axes: (Vector3 | null)[];
  private columns = new Map<string, Columns>();

  constructor(
    readonly robot: RobotEntry,
    private readonly side: Side,
  ) {
    this.links = robot.links.map(() => new Matrix4());
    this.offsets = robot.links.map((link) => matrix_of(link.offset));
    this.axes = robot.links.map((link) =>
      link.joint && link.joint.type !== 'fixed' ? new Vector3(...link.joint.axis).normalize() : null,
    );
  }

  /** Decodes what moves it. */
  async load(report: Report) {
    const names = series_of(this.robot);
    await Promise.all(
      names.map(async (name) => {
        const series = report.find(name);
        if (series) this.columns.set(name, await series.load());
      }),
    );
    this.present = names.length === 0 || names.some((name) => this.values(name) !== null);
  }

  private values(name: string): Values | null {
    return this.columns.get(name)?.[this.side] ?? null;
  }

  private value(name: string, tick: number, otherwise: number): number {
    const values = this.values(name);
    if (!values || values.axis.count === 0) return otherwise;
    const value = values.numbers[Math.max(0, values.axis.index_at(tick))]!;
    return Number.isFinite(value) ? value : otherwise;
  }

  private free_pose({ pose, fixed }: LinkEntry, tick: number): PoseEntry {
    if (!pose) return fixed ?? [0, 0, 0, 0, 0, 0, 1];
    return pose.map((name, i) => this.value(name, tick, i === 6 ? 1 : 0)) as PoseEntry;
  }

  private readonly motion = new Matrix4();
  private readonly turn = new Quaternion();

  private joint_motion(link: LinkEntry, axis: Vector3, tick: number): Matrix4 {
    const joint = link.joint!;
    const q = joint.q === null ? (joint.q0 ?? 0) : (this.joints[joint.q] = this.value(joint.q, tick, 0));
    return joint.type === 'prismatic'
      ? this.motion.makeTranslation(axis.x * q, axis.y * q, axis.z * q)
      : this.motion.makeRotationFromQuaternion(this.turn.setFromAxisAngle(axis, q));
  }

  /** Puts the links where they are at that tick. */
  update(tick: number) {
    this.robot.links.forEach((link, i) => {
      const matrix = this.links[i]!;
      if (link.parent < 0) matrix_of(this.free_pose(link, tick), matrix).multiply(this.offsets[i]!);
      else if (link.pose) matrix_of(this.free_pose(link, tick), matrix); // behind a floating joint
      else matrix.multiplyMatrices(this.links[link.parent]!, this.offsets[i]!);
      const axis = this.axes[i];
      if (axis) matrix.multiply(this.joint_motion(link, axis, tick));
    });
  }
}
