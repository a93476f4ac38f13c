// Makes a folder with an absolute name, and counts its files there.
#include "zoo.h"

#include <dirent.h>
#include <sys/stat.h>

#include <fstream>

namespace {

class OwnFolder : public ZooController {
  bool begin() override {
    const std::string folder = options().substr(0, options().rfind('/')) + "/zoo_own";
    mkdir(folder.c_str(), 0777);
    for (const char* name : {"b", "a", "c"}) std::ofstream(folder + "/" + name) << name;
    DIR* list = opendir(folder.c_str());
    while (readdir(list)) ++count_;
    closedir(list);
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(OwnFolder)
