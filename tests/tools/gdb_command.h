// A test whose commands start gdb; it is skipped where gdb is missing or may trace nothing.
#pragma once

#include "command.h"

namespace rehearse::test {

class GdbCommand : public Command {
 protected:
  void SetUp() override {
    const std::string said = test::run("gdb -nx -batch -ex run -ex 'info program' --args true").text;
    if (said.find("exited normally") == std::string::npos)
      GTEST_SKIP() << "gdb is not installed, or may trace nothing here: " << said;
  }

  static constexpr const char* environment = "ASAN_OPTIONS=detect_leaks=0";  // LeakSanitizer is a debugger itself
};

}  // namespace rehearse::test
