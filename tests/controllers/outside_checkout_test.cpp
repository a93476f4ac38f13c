// Projects and bodies of other people's repositories, imported as they are: checkouts below a folder that is named at
// configure time, cmake -DREHEARSE_OUTSIDE_PROJECTS=DIR, each in OWNER+NAME. Their files aren't part of this
// repository, so without the folder these tests are skipped. The files that ${SHARE} means are those of
// -DREHEARSE_CHOREONOID_SOURCE.
//
// The rule: a project whose files are in its repository and that holds a world imports. A refusal is right if the file
// that it reports isn't there, which is tested on the disk; every other refusal fails the test. Each is printed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/body.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "choreonoid/import/import.h"
#include "support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using rehearse::Diagnostic;
using rehearse::Diagnostics;

/// How many of a repository's projects and bodies are read at least.
struct Least {
  std::size_t projects;
  std::size_t bodies;
};

const std::map<std::string, Least> least{{"CAST-Robotics+surena_choreonoid_ros", {3, 1}},
                                         {"Hayabusa6863+choreonoid_ros_practice", {3, 6}},
                                         {"IRSL-tut+irsl_choreonoid", {0, 1}},
                                         {"IRSL-tut+irsl_choreonoid_ros", {1, 4}},
                                         {"MA1-Biped+vnoid", {9, 10}},
                                         {"MSakai-1+choreonoid_ros_tutorial", {2, 0}},
                                         {"MasutaniLab+CraneplusForChoreonoid", {1, 3}},
                                         {"MasutaniLab+KobukiForChoreonoid", {2, 5}},
                                         {"Negar-Riahi+surenav_choreonoid_sim", {0, 53}},
                                         {"choreonoid+choreonoid_ros2_mobile_robot_tutorial", {0, 2}},
                                         {"choreonoid+choreonoid_ros_mobile_robot_tutorial", {0, 1}},
                                         {"choreonoid+choreonoid_ros_tank_tutorial", {4, 0}},
                                         {"choreonoid+cnoid_tank_pkgs", {1, 2}},
                                         {"choreonoid+jaxon2-draft", {0, 8}},
                                         {"e-kaneko1719+cnoid-sandbox", {11, 29}},
                                         {"eicha178+choreonoid_ros_tank", {2, 4}},
                                         {"gomi-kuzu+choreonoid_ros_sim", {6, 14}},
                                         {"hayat0-ota+choreonoid-simple-controllers", {1, 1}},
                                         {"hvac-solver+vnoid2022", {2, 5}},
                                         {"inSect-WRS2025+hairo-world-plugin", {37, 56}},
                                         {"jadsys+cnoid_rover_pkgs", {0, 2}},
                                         {"jvrc+JVRCPlugin", {1, 0}},
                                         {"jvrc+model", {9, 0}},
                                         {"k38-suzuki+hairo-world-plugin", {50, 60}},
                                         {"kagenel+cnoid_simulator", {0, 2}},
                                         {"keitaronaruse+cnoid-ext-nrs", {4, 4}},
                                         {"keitaronaruse+cnoid-ext-ws", {25, 37}},
                                         {"kindsenior+jsk_choreonoid", {0, 1}},
                                         {"kirohy+amphibious_choreonoid", {0, 4}},
                                         {"koomiy+vnoid", {9, 10}},
                                         {"kyawawa+choreonoid_plugins", {1, 3}},
                                         {"mmurooka+vnoid", {1, 2}},
                                         {"niitblue+niitblue_cnoid_ext", {0, 1}},
                                         {"s-kajita+thormang3_cnoid", {1, 3}},
                                         {"s-nakaoka+choreonoid_ros_tank_tutorial", {5, 0}},
                                         {"start-jsk+rtmros_choreonoid", {2, 3}},
                                         {"tut201836+vnoid", {14, 14}},
                                         {"yoshiko-kulala+choreonoid_ros2_sample_drone_tutorial", {2, 1}},
                                         {"ytazz+vnoid", {15, 13}}};

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// The last folder and the name of a path; only the name if it has no folder.
std::string end_of(const std::string& path) {
  const fs::path whole(path);
  return (whole.parent_path().filename() / whole.filename()).generic_string();
}

struct Repository {
  fs::path root;
  std::set<fs::path> projects, bodies;
  std::set<std::string> ends;  // of all files: folder/name

  explicit Repository(const fs::path& folder) : root(folder) {
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      if (!entry.is_regular_file()) continue;
      if (entry.path().extension() == ".cnoid") projects.insert(entry.path());
      if (entry.path().extension() == ".body") bodies.insert(entry.path());
      ends.insert(end_of(entry.path().string()));
    }
  }

  /// The project's own folder counts, and a path without a folder is below it.
  bool has(const std::string& named, const fs::path& project) const {
    std::error_code ignored;
    return ends.contains(end_of(named)) || fs::exists(project.parent_path() / fs::path(named).filename(), ignored);
  }
};

const std::string wrong = "a reason of this program";

/// The kind of a mistake: "" for one that follows from others, `wrong` for one that is none of the repository.
std::string kind_of(const Diagnostic& mistake, const Repository& repository, const fs::path& file) {
  const std::string& message = mistake.message;
  const auto says = [&](const char* words) { return message.find(words) != std::string::npos; };
  std::smatch part;
  std::error_code ignored;
  if (std::regex_search(message, part, std::regex("there is no model file '([^']*)'")))
    return repository.has(part[1], file) ? wrong : "a body's file isn't in the repository";
  if (std::regex_search(message, part, std::regex("^the mesh .*: there is no '([^']*)' in (.*)$")))
    return fs::exists(fs::path(part[2].str()) / part[1].str(), ignored) ? wrong
                                                                        : "a mesh isn't where its body names it";
  if (std::regex_search(message, part, std::regex("^the (?:model|sub-body) .*: there is no '([^']*)' in (.*)$")))
    return fs::exists(fs::path(part[2].str()) / part[1].str(), ignored) ? wrong
                                                                        : "a body's file isn't in the repository";
  const std::string text = text_of(file);
  if (says("the project has no WorldItem"))
    return text.find("WorldItem") == std::string::npos ? "the project holds no world" : wrong;
  if (says("no BodyItem is below the world"))
    return text.find(" BodyItem") == std::string::npos ? "the project's scripts make the bodies" : wrong;
  if (says("it isn't a Choreonoid project"))
    return text.find("items:") == std::string::npos ? "it is no project" : wrong;
  if (says("can't be read as YAML") && std::regex_search(text, std::regex("@[A-Z_]+@")))
    return "it is a template of CMake";
  if (says("it is a git-lfs pointer")) return "its repository has it by Git LFS, and the copy lacks it";
  if (says("center_of_mass isn't a list of 3 numbers")) return "its own mistake: a centre of mass that is no list";
  if (says("a link has no name")) return "its own mistake: a link without a name";
  if (says("moves but has no mass")) return "its own mistake: a link that moves and has no mass";
  if (says("is a template of ROS")) return "the body is a template of ROS";
  if (says("can't be used") && !says("can't be used: ")) return "";  // its own mistakes follow
  if (mistake.severity == rehearse::Severity::note) return "";
  return wrong;
}

/// What stops a file, in one line.
struct Refusal {
  std::string kind;
  std::string line;
};

Refusal refusal_of(const Diagnostics& mistakes, const Repository& repository, const fs::path& file) {
  Refusal refusal;
  for (const Diagnostic& mistake : mistakes) {
    const std::string kind = kind_of(mistake, repository, file);
    if (kind.empty() || (!refusal.kind.empty() && kind != wrong)) continue;
    refusal = {kind, mistake.message};
    if (kind == wrong) break;
  }
  if (refusal.kind.empty()) refusal.kind = wrong;
  refusal.line = file.lexically_relative(repository.root).string() + ": " + refusal.line;
  return refusal;
}

class OutsideRepositories : public testing::Test {
 protected:
  void SetUp() override {
    if (*OUTSIDE_PROJECTS == '\0') GTEST_SKIP() << "there is no folder of checkouts: -DREHEARSE_OUTSIDE_PROJECTS=DIR";
    if (*CHOREONOID_SOURCE == '\0')
      GTEST_SKIP() << "there is no checkout of Choreonoid: -DREHEARSE_CHOREONOID_SOURCE=DIR";
    options_.model.allow_unknown_devices = true;
    options_.share = fs::path(CHOREONOID_SOURCE) / "share";
    options_.folder = folder_.path();
    std::set<fs::path> folders;
    for (const auto& entry : fs::directory_iterator(OUTSIDE_PROJECTS))
      if (entry.path().filename().string().find('+') != std::string::npos) folders.insert(entry.path());
    for (const fs::path& folder : folders) repositories_.emplace_back(folder);
  }

  /// Empty if the project becomes a scenario that loads.
  Diagnostics import(const fs::path& project, const rehearse::ImportOptions& options) const {
    const auto imported = rehearse::import_project(project, options);
    if (!imported) return imported.errors();
    for (const auto& [name, text] : imported->files) std::ofstream(folder_ / name) << text;
    const fs::path file = folder_ / (imported->name + ".yaml");
    std::ofstream(file) << imported->scenario;
    const auto scenario = rehearse::Scenario::load(file);
    return scenario ? Diagnostics() : scenario.errors();
  }

  const rehearse::test::TemporaryFolder folder_;
  rehearse::ImportOptions options_;
  std::vector<Repository> repositories_;
};

/// Counts refusals by their kinds, and prints each.
class Table {
 public:
  void add(const Diagnostics& mistakes, const Repository& repository, const fs::path& file) {
    ++files_;
    if (mistakes.empty()) return;
    const Refusal refusal = refusal_of(mistakes, repository, file);
    ++counts_[refusal.kind];
    std::cout << "  " << refusal.line << "\n";
    EXPECT_NE(refusal.kind, wrong) << refusal.line << "\n" << rehearse::to_string(mistakes);
  }
  void print(const char* files) const {
    std::size_t refused = 0;
    for (const auto& [kind, count] : counts_) refused += count;
    std::cout << files_ - refused << " of " << files_ << " " << files << " are read\n";
    for (const auto& [kind, count] : counts_) std::cout << "  " << count << ": " << kind << "\n";
  }

 private:
  std::size_t files_ = 0;
  std::map<std::string, std::size_t> counts_;
};

TEST_F(OutsideRepositories, ImportIfTheirFilesAreThereAndTheyHoldAWorld) {
  Table projects, bodies;
  for (const Repository& repository : repositories_) {
    std::size_t imported = 0, loaded = 0;
    const std::string name = repository.root.filename().string();
    std::cout << name << "\n";
    for (const fs::path& project : repository.projects) {
      const Diagnostics mistakes = import(project, options_);
      projects.add(mistakes, repository, project);
      imported += mistakes.empty();
    }
    for (const fs::path& body : repository.bodies) {
      const auto model = rehearse::load_model(body, options_.model);
      bodies.add(model ? Diagnostics() : model.errors(), repository, body);
      loaded += model.ok();
    }
    std::cout << "  " << imported << " of " << repository.projects.size() << " projects, " << loaded << " of "
              << repository.bodies.size() << " bodies\n";
    if (!least.contains(name)) continue;
    EXPECT_GE(imported, least.at(name).projects) << name;
    EXPECT_GE(loaded, least.at(name).bodies) << name;
  }
  projects.print("projects");
  bodies.print("bodies");
}

/// With --allow-missing-meshes, as Choreonoid does, and with --search of the other checkouts.
TEST_F(OutsideRepositories, ImportFurtherWithFilesOfOtherCheckouts) {
  std::size_t all = 0, strict = 0, searched = 0, lenient = 0, both = 0;
  for (const Repository& repository : repositories_) {
    for (const fs::path& project : repository.projects) {
      ++all;
      rehearse::ImportOptions options = options_;
      const bool imports = import(project, options).empty();
      for (const Repository& other : repositories_)
        if (other.root != repository.root) options.search.push_back(other.root);
      const bool with_search = imports || import(project, options).empty();
      options.model.allow_missing_meshes = true;
      const bool with_both = with_search || import(project, options).empty();
      options.search.clear();
      strict += imports;
      searched += with_search;
      lenient += imports || import(project, options).empty();
      both += with_both;
    }
  }
  std::cout << "of " << all << " projects import: " << strict << "; with --search of the other checkouts " << searched
            << "; with --allow-missing-meshes " << lenient << "; with both " << both << "\n";
  EXPECT_GE(searched, strict);
  if (all >= 361) {
    EXPECT_GE(searched, 233u);
    EXPECT_GE(both, 277u);
  }
}

}  // namespace
