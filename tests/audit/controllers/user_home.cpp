// Its command depends on the length of the user's home folder.
#include "zoo.h"

#include <pwd.h>
#include <unistd.h>
#include <string>

namespace {

class UserHome : public ZooController {
  double term() override {
    const passwd* user = getpwuid(getuid());
    return user ? 1e-4 * std::string(user->pw_dir).size() : 0.0;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(UserHome)
