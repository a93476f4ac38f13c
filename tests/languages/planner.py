"""planner.cpp in Python: threads of the interpreter, whose lock is one like others."""

import queue
import threading

import rehearse


class Planner(rehearse.Controller):
    def initialize(self, io):
        self.hinge = io.joint("hinge")
        self.hinge.read("q")
        self.hinge.command("u")
        self.angles, self.plans = queue.Queue(), queue.Queue()
        self.plan, self.count = 0.0, 0.0
        self.lock = threading.Lock()
        self.thread = threading.Thread(target=self.make_plans, name="planner", daemon=True)
        self.thread.start()

    def make_plans(self):
        while (angle := self.angles.get()) is not None:
            with self.lock:
                self.count += 1
            self.plans.put(-4.0 * angle)

    def work(self, share):
        with self.lock:
            self.count = 2.0 * self.count % 1000.0 + share

    def control(self):
        workers = [threading.Thread(target=self.work, args=(share,)) for share in range(2)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        while not self.plans.empty():
            self.plan = self.plans.get()
        self.angles.put(self.hinge.q)
        self.hinge.u = self.plan + 1e-6 * self.count

    def stop(self):
        self.angles.put(None)
        self.thread.join()
