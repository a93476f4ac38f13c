// Counts its ticks in shared memory, from 0 on.
#include "zoo.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace {

class SharedMemory : public ZooController {
  bool begin() override {
    const int file = shm_open("/zoo_good_shared_memory", O_CREAT | O_RDWR, 0600);
    if (file < 0 || ftruncate(file, sizeof(int)) != 0) return false;
    ticks_ = static_cast<int*>(mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0));
    close(file);
    *ticks_ = 0;
    return true;
  }
  double term() override { return 1e-6 * ++*ticks_; }
  int* ticks_ = nullptr;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SharedMemory)
