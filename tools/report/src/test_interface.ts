// window.rehearse: for tests and for the browser's console. README.md describes it.
import type { Cameras } from './cameras';
import type { Plots } from './plots';
import type { Scene } from './scene';
import type { Store } from './store';
import type { Table } from './table';

export function test_interface(
  store: Store,
  ready: Promise<void>,
  parts: { scene: Scene; plots: Plots; cameras: Cameras; table: Table },
) {
  const { scene, plots, cameras, table } = parts;

  async function settled() {
    await store.told();
    await Promise.all([plots.drawn(), cameras.drawn(), table.drawn()]);
    await store.told();
  }

  return {
    ready,
    get tick() {
      return store.tick;
    },
    /** Once all that is shown belongs to that tick. */
    async go(tick: number) {
      store.go(tick);
      await settled();
    },
    settled,
    state() {
      return {
        tick: store.tick,
        view: { ...store.view },
        shown: [...store.shown],
        playing: store.playing,
        table: table.shown(),
        frames: cameras.frames(),
        joints: scene.joints(),
        golden_joints: scene.joints('golden'),
        links: scene.links(),
        plots: plots.cursors(),
        drawings: scene.drawings,
        robot: scene.main_on_screen(),
      };
    },
    /** Frames a second while the cursor is moved through the whole run as fast as frames come, for that many of them. */
    async scrub_rate(frames = 60): Promise<number> {
      const { begin } = store.report.data,
        { last } = store.report;
      const frame = () => new Promise<number>((resolve) => requestAnimationFrame(resolve));
      const tick = store.tick;
      store.go(begin);
      await settled();
      await frame();
      const from = performance.now();
      for (let i = 1; i <= frames; ++i) {
        store.go(begin + ((last - begin) * i) / frames);
        await frame();
      }
      await store.told();
      const rate = (frames * 1000) / (performance.now() - from);
      store.go(tick);
      await settled();
      return rate;
    },
  };
}

export type TestInterface = ReturnType<typeof test_interface>;

declare global {
  interface Window {
    rehearse: TestInterface;
  }
}
