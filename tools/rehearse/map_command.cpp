// rehearse map: writes a first map from a log to a model.
#include <fmt/format.h>
#include <rehearse/body.h>
#include <rehearse/mcap.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "base/write_hint.h"
#include "command.h"
#include "logs/map/map_draft.h"
#include "options.h"
#include "output.h"

namespace rehearse::tool {
namespace {

struct MapSettings {
  std::string log;
  std::string model;
  std::string output = "-";
};

Exit write_map(const MapSettings& settings, const std::string& text) {
  if (settings.output == "-") {
    fmt::print("{}", text);
    return Exit::done;
  }
  std::error_code ignored;
  if (std::filesystem::exists(settings.output, ignored))
    return refuse(error_in(settings.output, "it exists, and a map may have been changed by hand", "name another file"));
  std::ofstream file(settings.output, std::ios::binary);
  if (!(file << text).flush())
    return refuse(
        error_in(settings.output, "it can't be written", write_hint(settings.output, "name another file with -o")));
  fmt::print("wrote {}; replay it with: rehearse replay {} --controller LIB --model {} --map {}\n", settings.output,
             settings.log, settings.model, settings.output);
  return Exit::done;
}

Exit run_map(const MapSettings& settings) {
  const auto log = mcap::Reader::open(settings.log);
  if (!log) return refuse(log.errors());
  UrdfOptions options;
  options.meshes = UrdfOptions::Meshes::skip;
  const auto model = load_model(settings.model, options);
  if (!model) return refuse(model.errors());
  const auto text = draft_map(**log, *model);
  if (!text) return refuse(text.errors());
  return write_map(settings, *text);
}

std::function<Exit()> declare_map(CLI::App& options) {
  const auto settings = std::make_shared<MapSettings>();
  options.add_option("LOG", settings->log, "a robot's log: MCAP, a rosbag2 folder or database, or a bag of ROS 1")
      ->required()
      ->type_name("");
  options.add_option("--model", settings->model, "the robot, a URDF or .body file")->required()->type_name("FILE");
  options.add_option("-o,--output", settings->output, "the map, a new file (standard output)")->type_name("FILE");
  return [settings] { return run_map(*settings); };
}

}  // namespace

extern const Verb map_verb{
    "map",
    "  rehearse map friday/ --model robot.urdf -o friday.map.yaml\n"
    "  rehearse replay friday/ --controller LIB --model robot.urdf --map friday.map.yaml\n"
    "\n"
    "Topics are assigned by their types, frames and names, joints by theirs. Each guess has a comment; "
    "\"unsure\" marks those to check.\n",
    declare_map};

}  // namespace rehearse::tool
