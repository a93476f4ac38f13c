// check --explain: of faults planted in a project of `rehearse new`, how many a script that reads only the JSON names
// by file and line.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "gdb_command.h"

namespace rehearse::test {
namespace {

using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;

/// A text of a file that is replaced by another one.
struct Fault {
  const char* name;
  const char* file;
  const char* before;
  const char* after;
  const char* line;  // the text of the line that has to be named; the first of the file
  bool by_day = true;
};

const std::vector<Fault>& faults() {
  static const std::vector<Fault> all{
      {"a stiffness", "hold.c", "stiffness = 60.0", "stiffness = 37.0", "return rehearse_set("},
      {"a sign", "hold.c", "- damping * dq", "+ damping * dq", "return rehearse_set(", false},
      {"a crash", "hold.c", "const double q =", "*(volatile int*)0 = 1;\n  const double q =", "*(volatile int*)0"},
      {"a command that isn't finite", "hold.c", "stiffness * (hold", "0.0 / 0.0 * (hold", "return rehearse_set(",
       false},
      {"gravity", "scenarios/hold.yaml", "bodies:", "gravity: [0, 0, -9.0]\nbodies:", "gravity:"},
      {"a posture", "scenarios/hold.yaml", "SHOULDER: -45", "SHOULDER: -44", "joints: {SHOULDER", false},
      {"a push", "scenarios/hold.yaml", "force: [25", "force: [26", "force: [26", false},
      {"a mass", "models/arm.urdf", "<mass value=\"1\"", "<mass value=\"1.1\"", "<mass value=\"1.1\""},
      {"an expectation", "scenarios/hold.yaml", "below: 40", "below: 1", "below: 1}"},
      {"a joint's name", "scenarios/hold.yaml", "joints: {SHOULDER", "joints: {SHOULDR", "joints: {SHOULDR"}};
  return all;
}

class Explained : public GdbCommand {
 protected:
  Outcome shell(const std::string& line, const std::string& more = "CI=") const {
    return run("/bin/sh", {"-c", "cd arm && " + line}, "CMAKE_PREFIX_PATH=" BUILD_FOLDER " " + more);
  }
  void make_project(const std::string& language) const {
    ASSERT_EQ(rehearse({"new", "--language", language, "arm"}).status, 0);
    const Outcome made = shell("cmake -S . -B build && cmake --build build --target Hold");
    ASSERT_EQ(made.status, 0) << made.out << made.err;
    shell(check, "CI= REHEARSE_GOLDEN=new");
  }
  std::string read(const std::string& file) const {
    std::ifstream stream(folder() / "arm" / file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void write_file(const std::string& file, const std::string& text) const {
    std::ofstream(folder() / "arm" / file) << text;
  }
  nlohmann::json explanation() const {
    const Outcome outcome = shell("cmake --build build --target Hold > /dev/null && " + check + " --explain --json");
    const nlohmann::json checked = outcome.json();
    if (checked.contains("errors")) return {{"places", checked["errors"]}, {"next", nlohmann::json::array()}};
    return checked.at("explanation");
  }

  const std::string rehearse_word = quoted(command.string()), check = rehearse_word + " check --no-report";
};

/// 1-based; 0: no line has it.
int line_with(const std::string& text, const std::string& part) {
  const std::size_t place = text.find(part);
  return place == std::string::npos
             ? 0
             : 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
}

TEST_F(Explained, AScriptThatReadsTheJsonNamesEachOfTenFaultsByFileAndLine) {
  make_project("c");
  for (const Fault& fault : faults()) {
    if (!fault.by_day && !AT_NIGHT) continue;
    const std::string before = read(fault.file);
    std::string text = before;
    ASSERT_NE(text.find(fault.before), std::string::npos) << fault.name;
    write_file(fault.file, text.replace(text.find(fault.before), std::string(fault.before).size(), fault.after));
    const nlohmann::json explained = explanation();
    write_file(fault.file, before);
    ASSERT_FALSE(explained["places"].empty()) << fault.name << ": " << explained;
    const nlohmann::json& first = explained["places"][0];
    EXPECT_THAT(first["file"].get<std::string>(), EndsWith(fault.file)) << fault.name << ": " << explained;
    EXPECT_EQ(first["line"], line_with(text, fault.line)) << fault.name << ": " << explained;
  }
}

TEST_F(Explained, TheNextCommandComparesWithTheGoldensCommit) {
  if (!AT_NIGHT) GTEST_SKIP() << "at night: it compiles C++ for half a minute";
  if (test::run("git --version").status != 0) GTEST_SKIP() << "git isn't installed";
  make_project("cpp");
  shell("git init -q . && git add . && git -c user.name=t -c user.email=t@t commit -qm golden");
  const std::string before = read("hold.cpp");
  std::string text = before;
  const std::string old = "damping * shoulder";
  ASSERT_NE(text.find(old), std::string::npos);
  write_file("hold.cpp", text.replace(text.find(old), old.size(), "0.5 * damping * shoulder"));
  const nlohmann::json explained = explanation();
  ASSERT_FALSE(explained["places"].empty()) << explained;
  EXPECT_EQ(explained["places"][0]["line"], line_with(text, "0.5 * damping")) << explained;
  EXPECT_THAT(explained["next"].get<std::vector<std::string>>(), Contains(HasSubstr(" --beside ")));
}

TEST_F(Explained, AGreenCheckHasNoExplanation) {
  make_project("c");
  EXPECT_TRUE(explanation().is_null());
}

}  // namespace
}  // namespace rehearse::test
