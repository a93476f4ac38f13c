// The appearance of a robot: its links' shapes as three.js objects, for the run or as the golden's ghost.
import * as three from 'three';
import { numbers_of } from './blobs';
import type { MeshEntry, RobotEntry, ShapeEntry } from './format';
import { matrix_of, type Kinematics } from './kinematics';

/** The geometry of each mesh, decoded once for all who have it. */
export class Meshes {
  private readonly geometries = new Map<number, Promise<three.BufferGeometry>>();

  constructor(private readonly entries: MeshEntry[]) {}

  load(index: number): Promise<three.BufferGeometry> {
    let geometry = this.geometries.get(index);
    if (!geometry) this.geometries.set(index, (geometry = this.decode(index)));
    return geometry;
  }

  private async decode(index: number): Promise<three.BufferGeometry> {
    const entry = this.entries[index];
    if (!entry) throw new Error(`there is no mesh ${index}`);
    const [positions, indices, color] = await Promise.all([
      numbers_of(entry.positions),
      numbers_of(entry.indices),
      entry.color && numbers_of(entry.color),
    ]);
    const shared = new three.BufferGeometry();
    shared.setAttribute('position', new three.BufferAttribute(positions as Float32Array, 3));
    if (color) shared.setAttribute('color', new three.BufferAttribute(color as Uint8Array, 4, true));
    shared.setIndex(new three.BufferAttribute(indices as Uint32Array, 1));
    if (color) {
      shared.computeVertexNormals();
      return shared;
    }
    // flat shading: edges of machine parts stay sharp
    const flat = shared.toNonIndexed();
    flat.computeVertexNormals();
    return flat;
  }
}

async function geometry_of(shape: ShapeEntry, meshes: Meshes): Promise<three.BufferGeometry> {
  if (shape.box) return new three.BoxGeometry(...shape.box);
  if (shape.sphere !== undefined) return new three.SphereGeometry(shape.sphere, 32, 16);
  if (shape.cylinder)
    return new three.CylinderGeometry(shape.cylinder.radius, shape.cylinder.radius, shape.cylinder.length, 32).rotateX(
      Math.PI / 2,
    );
  return meshes.load(shape.mesh ?? -1);
}

// Squares of a second colour on the upper face of a box.
function checkered(shape: ShapeEntry, geometry: three.BufferGeometry): three.Texture {
  const { color, size } = shape.checker!,
    [x, y] = shape.box!;
  const bytes = [shape.color, color, color, shape.color].flatMap((one) =>
    [one[0], one[1], one[2], 1].map((part) => Math.round(255 * part)),
  );
  const texture = new three.DataTexture(new Uint8Array(bytes), 2, 2);
  texture.colorSpace = three.SRGBColorSpace;
  texture.wrapS = texture.wrapT = three.RepeatWrapping;
  texture.needsUpdate = true;
  const uv = geometry.getAttribute('uv');
  for (let i = 0; i < uv.count; ++i)
    uv.setXY(i, ((uv.getX(i) - 0.5) * x) / (2 * size), ((uv.getY(i) - 0.5) * y) / (2 * size));
  return texture;
}

function own_material(shape: ShapeEntry, geometry: three.BufferGeometry): three.Material {
  const [r, g, b, a] = shape.color;
  if (shape.checker && shape.box) return new three.MeshLambertMaterial({ map: checkered(shape, geometry) });
  const colored = geometry.hasAttribute('color');
  const color = colored ? new three.Color(1, 1, 1) : new three.Color().setRGB(r, g, b, three.SRGBColorSpace);
  return new three.MeshLambertMaterial({
    color,
    vertexColors: colored,
    transparent: a < 1,
    opacity: a,
    side: three.DoubleSide,
  });
}

/** A robot's shapes, each link a group; the groups are moved, nothing is made anew. */
export class Figure {
  readonly root = new three.Group();
  private readonly groups: three.Group[];

  constructor(
    readonly robot: RobotEntry,
    readonly kinematics: Kinematics,
    private readonly ghost: three.Material | null,
  ) {
    this.root.name = robot.name;
    this.groups = robot.links.map((link) => {
      const group = new three.Group();
      group.name = link.name;
      group.matrixAutoUpdate = false;
      this.root.add(group);
      return group;
    });
  }

  async load(meshes: Meshes) {
    await Promise.all(
      this.robot.links.map((link, i) =>
        Promise.all(
          link.shapes.map(async (shape) => {
            const geometry = await geometry_of(shape, meshes);
            const object = new three.Mesh(geometry, this.ghost ?? own_material(shape, geometry));
            const [x, y, z] = shape.scale ?? [1, 1, 1];
            object.matrixAutoUpdate = false;
            object.matrix.copy(matrix_of(shape.pose)).scale(new three.Vector3(x, y, z));
            this.groups[i]!.add(object);
          }),
        ),
      ),
    );
  }

  /** Corners of the boxes around all shapes, in the world [m]. */
  corners(): three.Vector3[] {
    const corners: three.Vector3[] = [];
    for (const shape of this.groups.flatMap((group) => group.children as three.Mesh[])) {
      shape.geometry.computeBoundingBox();
      const { min, max } = shape.geometry.boundingBox!;
      for (const x of [min.x, max.x])
        for (const y of [min.y, max.y])
          for (const z of [min.z, max.z]) corners.push(new three.Vector3(x, y, z).applyMatrix4(shape.matrixWorld));
    }
    return corners;
  }

  update() {
    this.groups.forEach((group, i) => group.matrix.copy(this.kinematics.links[i]!));
  }

  /** Links that stand where they stand in the other, to a tenth of a millimetre, are hidden: nobody sees them apart.
   * Returns how far they are apart at most [m], and which link is. */
  hide_common_links(other: Kinematics): { distance: number; link: string } {
    let most = { distance: 0, link: '' };
    this.groups.forEach((group, i) => {
      const distance = distance_of(this.kinematics.links[i]!, other.links[i]!);
      group.visible = distance > 1e-4;
      if (distance > most.distance) most = { distance, link: this.robot.links[i]!.name };
    });
    return most;
  }
}

// Compares the links' origins, and, because links may turn in place, points 0.1 m from them.
function distance_of(a: three.Matrix4, b: three.Matrix4): number {
  let square = 0,
    turned = 0;
  for (let i = 0; i < 12; ++i) {
    const difference = a.elements[i]! - b.elements[i]!;
    turned += difference * difference;
  }
  for (let i = 12; i < 15; ++i) square += (a.elements[i]! - b.elements[i]!) ** 2;
  return Math.max(Math.sqrt(square), 0.1 * Math.sqrt(turned));
}
