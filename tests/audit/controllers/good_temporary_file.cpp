// Writes, renames, reads and removes a temporary file with a fixed name.
#include "zoo.h"

#include <filesystem>
#include <fstream>

namespace {

class TemporaryFile : public ZooController {
  double term() override {
    namespace fs = std::filesystem;
    const fs::path file = fs::temp_directory_path() / "zoo_good_temporary_file.txt";
    const fs::path made = file.string() + ".made";
    std::ofstream(made) << std::hexfloat << joint_->q() << '\n';
    fs::rename(made, file);
    std::string text;
    std::ifstream(file) >> text;
    fs::remove(file);
    return fs::exists(file) ? 1.0 : -0.1 * std::strtod(text.c_str(), nullptr);
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TemporaryFile)
