// Creates a lock file, which must not exist before, and removes it at the end.
#include "zoo.h"

#include <fcntl.h>
#include <unistd.h>

namespace {

class LockFile : public ZooController {
  bool begin() override {
    const int file = open("/tmp/zoo_good_lock_file.lock", O_CREAT | O_EXCL | O_RDWR, 0600);
    if (file < 0) return false;
    close(file);
    return true;
  }
  double term() override { return -0.1 * joint_->q(); }
  void stop() override { unlink("/tmp/zoo_good_lock_file.lock"); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(LockFile)
