// The workflows and actions of GitHub Actions, examined by actionlint: this repository's, and that of `rehearse new`.
#include <gmock/gmock.h>

#include <fstream>

#include "node.h"
#include "support/files.h"

namespace rehearse::test {
namespace {

class Workflow : public NodeTest {
 protected:
  Output check(const fs::path& workflow) const {
    return run("node " + quoted(fs::path(INTEROP_DIR) / "check_workflow.mjs") + " " + quoted(workflow));
  }
  const fs::path ours_ = fs::path(SOURCE_DIR) / ".github/workflows/ci.yml";
};

TEST_F(Workflow, OfThisRepositoryIsValid) {
  int workflows = 0;
  for (const auto& file : fs::directory_iterator(ours_.parent_path())) {
    const Output found = check(file.path());
    EXPECT_EQ(found.status, 0) << found.text;
    ++workflows;
  }
  EXPECT_EQ(workflows, 4) << "of each push, of each night, of a release, and of accepted goldens";
}

TEST_F(Workflow, OfThisRepositorysActionsAreValid) {
  for (const char* name : {"install", "check", "accept"}) {
    const Output found = check(ours_.parent_path() / "../actions" / name / "action.yml");
    EXPECT_EQ(found.status, 0) << found.text;
  }
}

TEST_F(Workflow, AnActionThatUsesAnInputItDoesNotDeclareIsReported) {
  std::string wrong = read_file(ours_.parent_path() / "../actions/check/action.yml");
  wrong.replace(wrong.find("inputs.arguments"), 16, "inputs.argument_");
  std::ofstream(file_) << wrong;
  const Output found = check(file_);
  EXPECT_NE(found.status, 0) << found.text;
  EXPECT_THAT(found.text, testing::HasSubstr("property \"argument_\" is not defined"));
}

TEST_F(Workflow, OfANewProjectIsValid) {
  for (const char* language : {"c++", "c", "rust", "python"}) {
    const Output made =
        run(quoted(REHEARSE_COMMAND) + " new --origin https://github.com/owner/name --commit " + std::string(40, '1') +
            " --history branch " + "--language " + language + " " + quoted(file_));
    EXPECT_EQ(made.status, 0) << made.text;
    const Output found = check(file_ / ".github/workflows/test.yml");
    EXPECT_EQ(found.status, 0) << language << ": " << found.text;
    fs::remove_all(file_);
  }
}

TEST_F(Workflow, WithAMistakeIsReported) {
  std::string wrong = read_file(ours_);
  wrong.replace(wrong.find("runs-on"), 7, "runs_on");
  std::ofstream(file_) << wrong;
  const Output found = check(file_);
  EXPECT_NE(found.status, 0) << found.text;
  EXPECT_THAT(found.text, testing::HasSubstr("unexpected key \"runs_on\" for \"job\" section"));
}

}  // namespace
}  // namespace rehearse::test
