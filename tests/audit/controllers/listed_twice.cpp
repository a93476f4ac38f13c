// Lists a folder twice by one stream, and reads an entry again by its position.
#include "zoo.h"

#include <dirent.h>

namespace {

class ListedTwice : public ZooController {
  bool begin() override {
    const std::string path = options();
    DIR* list = opendir(path.substr(0, path.rfind('/')).c_str());
    while (readdir(list)) ++count_;
    rewinddir(list);
    readdir(list);
    const long position = telldir(list);
    const std::string second = readdir(list)->d_name;
    while (readdir(list)) ++count_;
    seekdir(list, position);
    same_ = second == readdir(list)->d_name;
    closedir(list);
    return true;
  }
  double term() override { return same_ ? 1e-9 * count_ : 1.0; }
  int count_ = 0;
  bool same_ = false;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ListedTwice)
