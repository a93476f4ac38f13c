// Each folder of engine/src, of harness/src/core and of a wing beside it is a room: a target that links the rooms it
// may use (rehearse_room in tools/cmake/RehearseTargets.cmake). This test reads the targets' graph, which CMake wrote
// into ROOMS, and the sources. It fails on a cycle, on an include that the links don't allow, on a link that no include
// needs, on a room of the core that uses a wing, and on a wing that uses another one without being listed here. The
// command and the Python module are programs.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

const fs::path root = fs::path(FIXTURES_DIR).parent_path();
const std::string prefix = "rehearse_room_";

struct Room {
  std::string folder;  // below the repository

  /// "core/mcap": its path in includes.
  std::string path() const { return folder.substr(folder.find("/src/") + 5); }
  /// The folder beside core that the room is in; empty: it is in the core or in the engine.
  std::string wing() const {
    const std::string place = path();
    const std::size_t slash = place.find('/');
    return slash == std::string::npos || place.rfind("core/", 0) == 0 ? "" : place.substr(0, slash);
  }
  std::vector<std::string> uses;    // names of the rooms that it links
  std::set<std::string> installed;  // its headers in include/rehearse
  std::set<std::string> doors;      // headers of its folder that programs may include
};
using Rooms = std::map<std::string, Room>;

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  parts.resize(std::max<std::size_t>(parts.size(), separator == '|' ? 5 : 0));
  return parts;
}

/// A line a room: target, folder, links, installed headers, doors.
Rooms read_rooms(std::istream& stream) {
  Rooms rooms;
  for (std::string line; std::getline(stream, line);) {
    const std::vector<std::string> columns = split(line, '|');
    Room& room = rooms[columns[0].substr(prefix.size())];
    room.folder = fs::path(columns[1]).lexically_relative(root).string();
    for (const std::string& link : split(columns[2], ';'))
      if (link.rfind(prefix, 0) == 0) room.uses.push_back(link.substr(prefix.size()));
    for (const std::string& header : split(columns[3], ';')) room.installed.insert(header);
    for (const std::string& header : split(columns[4], ';')) room.doors.insert(header);
  }
  return rooms;
}

const Rooms& rooms_of_the_build() {
  static const Rooms rooms = [] {
    std::ifstream stream(ROOMS);
    return read_rooms(stream);
  }();
  EXPECT_GT(rooms.size(), 20u) << ROOMS;
  return rooms;
}

/// "a uses b uses a"; empty: there is no cycle.
std::string cycle_in(const Rooms& rooms) {
  std::set<std::string> done;
  std::vector<std::string> path;
  const std::function<std::string(const std::string&)> visit = [&](const std::string& name) -> std::string {
    if (const auto begin = std::ranges::find(path, name); begin != path.end()) {
      std::string text;
      for (auto step = begin; step != path.end(); ++step) text += *step + " uses ";
      return text + name;
    }
    if (!done.insert(name).second) return {};
    path.push_back(name);
    for (const std::string& used : rooms.at(name).uses)
      if (std::string found = visit(used); !found.empty()) return found;
    path.pop_back();
    return {};
  };
  for (const auto& [name, room] : rooms)
    if (std::string found = visit(name); !found.empty()) return found;
  return {};
}

struct Include {
  int line = 0;
  std::string text;  // with its quotes or brackets
  std::string room;  // the room of the header; empty: of a different project, or of the file's own folder
  std::string header;
};

/// The rooms' headers that a file includes. A header in include/rehearse that belongs to no room counts to the room
/// "?".
std::vector<Include> includes_in(const Rooms& rooms, std::istream& stream) {
  static const std::regex form(R"re(\s*#include (<rehearse/([^>]+)>|"([^"]+)/([^"/]+)").*)re");
  std::vector<Include> found;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    std::smatch match;
    if (line.find("#include") == std::string::npos || !std::regex_match(line, match, form)) continue;
    Include include{number, match[1], match[3], match[4]};
    if (match[2].matched) {
      if (fs::exists(root / "controllers/include/rehearse" / match[2].str())) continue;  // of the controllers' API
      const auto owner =
          std::ranges::find_if(rooms, [&](const auto& room) { return room.second.installed.count(match[2]) > 0; });
      include.room = owner == rooms.end() ? "?" : owner->first;
      include.header = match[2];
    } else {
      const auto owner = std::ranges::find_if(rooms, [&](const auto& room) { return room.second.path() == match[3]; });
      if (owner == rooms.end()) continue;
      include.room = owner->first;
    }
    found.push_back(include);
  }
  return found;
}

std::string at(const std::string& file, const Include& include) {
  return file + ":" + std::to_string(include.line) + ": ";
}

/// Includes of a file of a room that the room's links don't allow. Also collects the included rooms.
std::vector<std::string> forbidden_in(const Rooms& rooms, const std::string& name, const std::string& file,
                                      std::istream& stream, std::set<std::string>& included) {
  std::vector<std::string> found;
  const std::vector<std::string>& uses = rooms.at(name).uses;
  for (const Include& include : includes_in(rooms, stream)) {
    included.insert(include.room);
    if (include.room == name || std::ranges::find(uses, include.room) != uses.end()) continue;
    found.push_back(at(file, include) + "the room " + name + " may not use the room " + include.room + ": " +
                    include.text);
  }
  return found;
}

/// Includes of a program that the header's room doesn't allow.
std::vector<std::string> past_doors_in(const Rooms& rooms, const std::string& file,
                                       const std::vector<Include>& includes) {
  std::vector<std::string> found;
  for (const Include& include : includes)
    if (include.text[0] == '"' && rooms.at(include.room).doors.count(include.header) == 0)
      found.push_back(at(file, include) + "programs may not include a header that the room " + include.room +
                      " keeps to itself: " + include.text);
  return found;
}

/// The sources in a folder, by path below the repository.
std::vector<std::string> sources_in(const std::string& folder) {
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(root / folder))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
      files.push_back(entry.path().lexically_relative(root).string());
  std::ranges::sort(files);
  return files;
}

std::string include_folder_of(const Room& room) {
  return (*fs::path(room.folder).begin() / "include" / "rehearse").string();
}

TEST(Rooms, HaveNoCycle) { EXPECT_EQ(cycle_in(rooms_of_the_build()), ""); }

TEST(Rooms, IncludeWhatTheyLinkAndLinkWhatTheyInclude) {
  const Rooms& rooms = rooms_of_the_build();
  for (const auto& [name, room] : rooms) {
    std::vector<std::string> files = sources_in(room.folder);
    for (const std::string& header : room.installed) files.push_back(include_folder_of(room) + "/" + header);
    std::set<std::string> included;
    for (const std::string& file : files) {
      std::ifstream stream(root / file);
      for (const std::string& finding : forbidden_in(rooms, name, file, stream, included)) ADD_FAILURE() << finding;
    }
    for (const std::string& used : room.uses)
      EXPECT_EQ(included.count(used), 1u) << room.folder << "/CMakeLists.txt: nothing in " << name << " uses " << used;
  }
}

TEST(Rooms, AreEnteredByProgramsThroughTheirDoors) {
  const Rooms& rooms = rooms_of_the_build();
  std::set<std::string> entered;
  std::vector<std::string> files = sources_in("tools/rehearse");
  for (std::string& file : sources_in("tools/python/src")) files.push_back(std::move(file));
  for (const std::string& file : files) {
    std::ifstream stream(root / file);
    const std::vector<Include> includes = includes_in(rooms, stream);
    for (const std::string& finding : past_doors_in(rooms, file, includes)) ADD_FAILURE() << finding;
    for (const Include& include : includes) entered.insert(include.room + "/" + include.header);
  }
  for (const auto& [name, room] : rooms)
    for (const std::string& door : room.doors)
      EXPECT_EQ(entered.count(name + "/" + door), 1u)
          << room.folder << "/CMakeLists.txt: no program includes " << door << ", which is no door then";
}

TEST(Rooms, AreAllFoldersOfSources) {
  std::set<std::string> folders;
  for (const auto& [name, room] : rooms_of_the_build()) folders.insert(room.folder);
  const auto expect_rooms_in = [&](const fs::path& part) {
    for (const fs::directory_entry& entry : fs::directory_iterator(part)) {
      const bool is_room = folders.count(entry.path().lexically_relative(root).string()) > 0;
      EXPECT_TRUE(is_room || !entry.is_directory()) << entry.path() << " is no room";
    }
  };
  expect_rooms_in(root / "engine/src");
  for (const fs::directory_entry& wing : fs::directory_iterator(root / "harness/src")) expect_rooms_in(wing.path());
}

/// Pairs of wings of which the first uses the second.
std::set<std::pair<std::string, std::string>> wings_that_use_wings(const Rooms& rooms) {
  std::set<std::pair<std::string, std::string>> pairs;
  for (const auto& [name, room] : rooms)
    for (const std::string& used : room.uses)
      if (const std::string wing = rooms.at(used).wing(); !wing.empty() && wing != room.wing())
        pairs.emplace(room.wing().empty() ? "core: " + name : room.wing(), wing);
  return pairs;
}

TEST(Rooms, OfTheCoreUseNoWingAndWingsUseViewing) {
  using Pairs = std::set<std::pair<std::string, std::string>>;
  const Pairs known{{"campaigns", "viewing"}, {"gtest", "viewing"}, {"gtest", "campaigns"}, {"fuzz", "gtest"}};
  EXPECT_EQ(wings_that_use_wings(rooms_of_the_build()), known);
}

TEST(Rooms, HaveEachInstalledHeaderOnce) {
  for (const char* part : {"engine", "harness"}) {
    for (const std::string& file : sources_in(std::string(part) + "/include/rehearse")) {
      const std::string header = fs::path(file).filename().string();
      int owners = 0;
      for (const auto& [name, room] : rooms_of_the_build())
        if (room.folder.rfind(part, 0) == 0) owners += static_cast<int>(room.installed.count(header));
      EXPECT_EQ(owners, 1) << file << " has to stand after PUBLIC of one room";
    }
  }
}

/// The README of each part has a row a room: | `compare` | what it is | what it uses |.
TEST(Rooms, AreInTheReadmesAsTheyAre) {
  static const std::regex row(R"(\| `(\w+)` \|.*\| ([a-z0-9_ ]*) ?\|)");
  for (const char* part : {"engine", "harness"}) {
    std::map<std::string, std::string> rows;
    std::ifstream stream(root / part / "README.md");
    for (std::string line; std::getline(stream, line);)
      if (std::smatch match; std::regex_match(line, match, row)) rows[match[1]] = match[2];
    for (const auto& [name, room] : rooms_of_the_build()) {
      if (room.folder.rfind(part, 0) != 0) continue;
      std::string uses;
      for (const std::string& used : room.uses) uses += (uses.empty() ? "" : " ") + used;
      const std::string stated = rows[name].substr(0, rows[name].find_last_not_of(' ') + 1);
      EXPECT_EQ(stated, uses.empty() ? "none" : uses) << part << "/README.md: " << name;
    }
  }
}

const Rooms two_rooms{{"cellar", {"harness/src/core/cellar", {}, {"cellar.h"}, {"door.h"}}},
                      {"attic", {"harness/src/views/attic", {"cellar"}, {"attic.h"}, {}}}};

std::vector<std::string> forbidden(const std::string& name, const std::string& source) {
  std::istringstream stream(source);
  std::set<std::string> included;
  return forbidden_in(two_rooms, name, "a.cpp", stream, included);
}

TEST(RoomsRule, FindsAnIncludeThatNoLinkAllows) {
  EXPECT_EQ(forbidden("attic", "#include <rehearse/cellar.h>\n#include \"core/cellar/wine.h\"\n#include \"own.h\"\n"),
            std::vector<std::string>{});
  EXPECT_EQ(forbidden("cellar", "// first\n#include \"views/attic/box.h\"\n"),
            std::vector<std::string>{"a.cpp:2: the room cellar may not use the room attic: \"views/attic/box.h\""});
  EXPECT_EQ(forbidden("cellar", "#include <rehearse/attic.h>\n"),
            std::vector<std::string>{"a.cpp:1: the room cellar may not use the room attic: <rehearse/attic.h>"});
  EXPECT_EQ(forbidden("attic", "#include <rehearse/garden.h>\n"),
            std::vector<std::string>{"a.cpp:1: the room attic may not use the room ?: <rehearse/garden.h>"});
}

TEST(RoomsRule, FindsACycle) {
  EXPECT_EQ(cycle_in(two_rooms), "");
  Rooms rooms = two_rooms;
  rooms["cellar"].uses.push_back("attic");
  EXPECT_EQ(cycle_in(rooms), "attic uses cellar uses attic");
}

TEST(RoomsRule, FindsARoomOfTheCoreThatUsesAWing) {
  using Pairs = std::set<std::pair<std::string, std::string>>;
  EXPECT_EQ(wings_that_use_wings(two_rooms), Pairs{});
  Rooms rooms = two_rooms;
  rooms["cellar"].uses.push_back("attic");
  EXPECT_EQ(wings_that_use_wings(rooms), (Pairs{{"core: cellar", "views"}}));
}

TEST(RoomsRule, FindsAProgramThatEntersByAWindow) {
  std::istringstream stream(
      "#include \"core/cellar/door.h\"\n#include \"core/cellar/window.h\"\n#include <rehearse/attic.h>\n");
  EXPECT_EQ(past_doors_in(two_rooms, "main.cpp", includes_in(two_rooms, stream)),
            std::vector<std::string>{"main.cpp:2: programs may not include a header that the room cellar keeps to "
                                     "itself: \"core/cellar/window.h\""});
}

}  // namespace
}  // namespace rehearse
