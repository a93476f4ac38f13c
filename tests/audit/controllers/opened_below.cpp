// Reads a file by its name in an opened folder.
#include "zoo.h"

#include <fcntl.h>
#include <unistd.h>

namespace {

class OpenedBelow : public ZooController {
  bool begin() override {
    const std::string path = options();
    const int folder = open(path.substr(0, path.rfind('/')).c_str(), O_RDONLY | O_DIRECTORY);
    const int file = openat(folder, path.substr(path.rfind('/') + 1).c_str(), O_RDONLY);
    char text[16] = "";
    size_ = read(file, text, sizeof text);
    close(file);
    close(folder);
    return true;
  }
  double term() override { return 1e-9 * size_; }
  double size_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(OpenedBelow)
