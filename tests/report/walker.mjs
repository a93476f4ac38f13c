// The figure of synthetic reports: two legs, a body, a head that is a mesh, a floor.

export const joints = ['LEFT_HIP', 'LEFT_KNEE', 'LEFT_ANKLE', 'RIGHT_HIP', 'RIGHT_KNEE', 'RIGHT_ANKLE'];

/** Where it is at a tick of 1 ms: root pose [m, quaternion] and joint displacements [rad]. */
export function pose_at(tick) {
  const phase = tick / 160;
  const leg = (shift) => {
    const hip = 0.35 * Math.sin(phase + shift),
      knee = 0.35 + 0.3 * Math.cos(phase + shift);
    return [-hip - knee / 2, knee, -knee / 2 + hip];
  };
  const half = 0.04 * Math.sin(phase);
  return {
    root: [
      tick * 2e-4,
      0.02 * Math.sin(phase),
      0.86 + 0.01 * Math.cos(2 * phase),
      0,
      0,
      Math.sin(half),
      Math.cos(half),
    ],
    joints: [...leg(0), ...leg(Math.PI)],
  };
}

const at = (x, y, z) => [x, y, z, 0, 0, 0, 1];

function limb(name, parent, joint, offset, shapes) {
  return { name, parent, joint: joint && { type: 'revolute', axis: [0, 1, 0], q: joint, q0: 0 }, offset, shapes };
}

// An octahedron, coloured by vertex.
function head_mesh(blobs) {
  const positions = Float32Array.from([1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1]);
  const indices = Uint32Array.from([0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5]);
  const color = Uint8Array.from([
    220, 90, 60, 255, 90, 90, 220, 255, 90, 200, 90, 255, 220, 200, 60, 255, 240, 240, 240, 255, 60, 60, 60, 255,
  ]);
  return {
    positions: blobs.numbers(positions, 'columns'),
    indices: blobs.numbers(indices, 'none'),
    color: blobs.numbers(color, 'none'),
  };
}

/** Robots and meshes of a report. Without series it stands still. */
export function walker(blobs, with_mesh, with_series) {
  const grey = [0.55, 0.58, 0.62, 1],
    dark = [0.25, 0.27, 0.3, 1],
    blue = [0.25, 0.4, 0.65, 1];
  const joint = (name) => (with_series ? `Walker/${name}/q` : null);
  const leg = (side, y, first) => [
    limb(`${side}_THIGH`, 0, joint(`${side}_HIP`), at(0, y, -0.1), [
      { pose: at(0, 0, -0.18), color: grey, cylinder: { radius: 0.05, length: 0.34 } },
    ]),
    limb(`${side}_SHANK`, first, joint(`${side}_KNEE`), at(0, 0, -0.36), [
      { pose: at(0, 0, 0), color: dark, sphere: 0.058 },
      { pose: at(0, 0, -0.17), color: grey, box: [0.08, 0.08, 0.3] },
    ]),
    limb(`${side}_FOOT`, first + 1, joint(`${side}_ANKLE`), at(0, 0, -0.34), [
      { pose: at(0.04, 0, -0.03), color: dark, box: [0.22, 0.1, 0.04] },
    ]),
  ];
  const head = {
    pose: at(0, 0, 0.42),
    color: [1, 1, 1, 1],
    ...(with_mesh ? { mesh: 0, scale: [0.11, 0.1, 0.14] } : { sphere: 0.11 }),
  };
  const pose = with_series ? ['x', 'y', 'z', 'qx', 'qy', 'qz', 'qw'].map((name) => `Walker/root/${name}`) : null;
  const links = [
    {
      name: 'WAIST',
      parent: -1,
      pose,
      ...(pose ? {} : { fixed: at(0, 0, 0.86) }),
      joint: null,
      offset: at(0, 0, 0),
      shapes: [{ pose: at(0, 0, 0.1), color: blue, box: [0.18, 0.3, 0.36] }, head],
    },
    ...leg('LEFT', 0.1, 1),
    ...leg('RIGHT', -0.1, 4),
  ];
  const floor = {
    name: 'Floor',
    links: [
      {
        name: 'Floor',
        parent: -1,
        pose: null,
        fixed: at(0, 0, -0.05),
        joint: null,
        offset: at(0, 0, 0),
        shapes: [
          {
            pose: at(0, 0, 0),
            color: [0.6, 0.6, 0.58, 1],
            box: [8, 4, 0.1],
            checker: { color: [0.56, 0.56, 0.54, 1], size: 0.25 },
          },
        ],
      },
    ],
  };
  return { robots: [{ name: 'Walker', links }, floor], meshes: with_mesh ? [head_mesh(blobs)] : [] };
}
