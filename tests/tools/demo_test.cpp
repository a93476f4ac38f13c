// tools/demo: its last part, which runs the command.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <string>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Demo : public Command {
 protected:
  /// The function demo() of the script, in a folder whose build has the command.
  Outcome demo() const {
    const fs::path source = fixtures.parent_path();
    std::error_code ignored;
    fs::create_directories(folder() / "build/bin", ignored);
    for (const char* name : {"fixtures", "golden", "controllers"})
      fs::create_directory_symlink(source / name, folder() / name, ignored);
    fs::create_symlink(command, folder() / "build/bin/rehearse", ignored);
    const std::string script = quoted((source / "tools/demo").string());
    return run("bash", {"-c", "set -euo pipefail; source <(sed -n '/^# seconds TEXT/,/^}/p' " + script + "); demo"});
  }
};

TEST_F(Demo, PrintsOneNumberOfPicturesAndAtMost25LinesInItsSecondRun) {
  EXPECT_EQ(demo().status, 0);
  const Outcome second = demo();
  EXPECT_EQ(second.status, 0) << second.err;
  const std::string script = read_file(fixtures.parent_path() / "tools/demo");
  std::ptrdiff_t steps = 0;  // lines before the last part: "1 of 3: ..."
  for (std::size_t at = 0; (at = script.find(" of 3: ", at)) != std::string::npos; ++at) ++steps;
  EXPECT_EQ(steps, 3);
  EXPECT_LE(std::ranges::count(second.out, '\n') + steps, 25) << second.out;
  std::set<std::string> counts;
  for (std::size_t at = 0; (at = second.out.find(" pictures", at)) != std::string::npos; ++at)
    counts.insert(second.out.substr(second.out.rfind(' ', at - 1) + 1, at - second.out.rfind(' ', at - 1) - 1));
  EXPECT_THAT(counts, ElementsAre("120"));
  EXPECT_THAT(second.out, HasSubstr("its report, with the golden beside the run: file://"));
  EXPECT_TRUE(exists("build/demo/sr1.html"));
}

}  // namespace
}  // namespace rehearse::test
