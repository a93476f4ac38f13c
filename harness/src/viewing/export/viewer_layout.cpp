// Layouts of viewers, and the files of a recording's robots.
#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/scenario/trace_scenario.h"
#include "export_files.h"
#include "viewer_export.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* colors[] = {"#4e98e2", "#f5774d", "#f7df71", "#5cd6a9", "#61cbff", "#a395e2"};
constexpr std::size_t most_curves = 12;  // limit of a plot

/// The parts of a recording that a layout shows.
struct Shown {
  std::vector<std::string> topics;
  Scenario scenario;

  bool has(const std::string& topic) const { return std::ranges::find(topics, topic) != topics.end(); }
  /// Topics with that end, as /image.
  std::vector<std::string> ending(std::string_view end) const {
    std::vector<std::string> found;
    for (const std::string& topic : topics)
      if (topic.ends_with(end)) found.push_back(topic);
    return found;
  }
  /// The first body with a controller; else the first body.
  const ScenarioBody& robot() const {
    for (const ScenarioBody& body : scenario.bodies)
      if (!body.controllers.empty()) return body;
    return scenario.bodies.front();
  }
};

Result<Shown> contents_of(const fs::path& trace) {
  const auto log = REHEARSE_TRY(mcap::Reader::open(trace));
  auto scenario = REHEARSE_TRY(scenario_of(*log));
  Shown shown{{}, std::move(scenario)};
  for (const auto& [id, channel] : log->channels()) shown.topics.push_back(channel.topic);
  return shown;
}

std::vector<std::string> joint_names(const ScenarioBody& body) {
  std::vector<std::string> names;
  for (const int link : body.model->joints) names.push_back(body.model->links[link].joint.name);
  return names;
}

/// The 3D panel: every description is shown, and the camera follows the robot. Viewers hide /robot_description by
/// default, and show each other description only in a separate layer.
Json panel_3d(const Shown& shown) {
  const ScenarioBody& robot = shown.robot();
  Json topics = Json::object(), layers = Json::object();
  layers["grid"] = {{"layerId", "foxglove.Grid"}, {"visible", true}, {"frameId", "world"}, {"size", 20}};
  for (const ScenarioBody& body : shown.scenario.bodies) {
    if (&body == &robot && !body.controllers.empty()) {
      topics["/robot_description"] = {{"visible", true}};
      continue;
    }
    const std::string topic = "/" + body.name + "/robot_description";
    layers[topic] = {{"layerId", "foxglove.Urdf"}, {"instanceId", topic}, {"label", body.name}, {"visible", true},
                     {"sourceType", "topic"},      {"topic", topic}};
  }
  for (const char* end : {"/scan", "/points"})
    for (const std::string& topic : shown.ending(end)) topics[topic] = {{"visible", true}, {"pointSize", 4}};
  for (const char* end : {"/contact", "/contacts"})
    for (const std::string& topic : shown.ending(end))
      if (topic != end) topics[topic + "/markers"] = {{"visible", true}};
  return {{"cameraState",
           {{"distance", 4},
            {"perspective", true},
            {"phi", 65},
            {"target", {0, 0, 0}},
            {"targetOffset", {0, 0, 0}},
            {"targetOrientation", {0, 0, 0, 1}},
            {"thetaOffset", 45},
            {"fovy", 45},
            {"near", 0.01},
            {"far", 5000}}},
          {"followMode", "follow-position"},
          {"followTf", robot.name + "/" + robot.model->links[0].name},
          {"fixedFrame", "world"},
          {"scene", {{"transforms", {{"showLabel", false}}}}},
          {"transforms", Json::object()},
          {"topics", topics},
          {"layers", layers},
          {"publish", Json::object()}};
}

Json curve(const std::string& path, const std::string& label, std::size_t number) {
  return {{"value", path},
          {"label", label},
          {"enabled", true},
          {"timestampMethod", "receiveTime"},
          {"color", colors[number % std::size(colors)]}};
}

/// A plot of one array of JointStates, a curve for each joint.
Json plot(const std::string& topic, const char* array, const std::string& title,
          const std::vector<std::string>& joints) {
  Json paths = Json::array();
  for (std::size_t i = 0; i < std::min(joints.size(), most_curves); ++i)
    paths.push_back(curve(fmt::format("{}.{}[{}]", topic, array, i), joints[i], i));
  return {{"paths", paths},   {"title", title},          {"showLegend", true},      {"legendDisplay", "left"},
          {"isSynced", true}, {"xAxisVal", "timestamp"}, {"showXAxisLabels", true}, {"showYAxisLabels", true}};
}

/// Panels one above the other, or side by side.
Json tree_of(const std::vector<std::string>& panels, std::size_t begin, const char* direction) {
  if (begin + 1 == panels.size()) return panels[begin];
  return {{"first", panels[begin]},
          {"second", tree_of(panels, begin + 1, direction)},
          {"direction", direction},
          {"splitPercentage", 100.0 / static_cast<double>(panels.size() - begin)}};
}

std::string layout_json(const Shown& shown) {
  Json configs = Json::object();
  configs["3D!robot"] = panel_3d(shown);
  std::vector<std::string> left{"3D!robot"}, right;
  std::size_t number = 0;
  for (const std::string& topic : shown.ending("/image")) {
    const std::string id = fmt::format("Image!camera{}", ++number);
    const std::string info = topic.substr(0, topic.rfind('/')) + "/camera_info";
    configs[id] = {{"cameraState", Json::object()},
                   {"imageMode", {{"imageTopic", topic}, {"calibrationTopic", shown.has(info) ? info : ""}}}};
    left.push_back(id);
  }
  for (const ScenarioBody& body : shown.scenario.bodies) {
    const std::vector<std::string> joints = joint_names(body);
    const std::string topic = "/" + body.name + "/joints";
    if (joints.empty() || !shown.has(topic)) continue;
    configs["Plot!" + body.name + "_q"] = plot(topic, "position", body.name + " positions", joints);
    right.push_back("Plot!" + body.name + "_q");
    for (const ScenarioController& controller : body.controllers) {
      const std::string output = fmt::format("/{}/{}/output/joints", body.name, controller.name);
      if (!shown.has(output)) continue;
      configs["Plot!" + body.name + "_" + controller.name] =
          plot(output, "effort", controller.name + " efforts", joints);
      right.push_back("Plot!" + body.name + "_" + controller.name);
    }
  }
  configs["RosOut!log"] = {{"searchTerms", Json::array()}, {"minLogLevel", 1}, {"topicToRender", "/rosout"}};
  right.push_back("RosOut!log");
  const Json layout{{"configById", configs},
                    {"globalVariables", Json::object()},
                    {"userNodes", Json::object()},
                    {"playbackConfig", {{"speed", 1}}},
                    {"layout",
                     {{"first", tree_of(left, 0, "column")},
                      {"second", tree_of(right, 0, "column")},
                      {"direction", "row"},
                      {"splitPercentage", 55}}}};
  return layout.dump(2) + "\n";
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

/// A plot of PlotJuggler, which names the numbers of a JointState TOPIC/JOINT/position.
std::string dock_area(const std::string& topic, const char* quantity, const std::vector<std::string>& joints) {
  std::string text = fmt::format("    <DockArea name=\"{}\">\n     <plot mode=\"TimeSeries\" style=\"Lines\">\n",
                                 escaped(topic + " " + quantity));
  for (std::size_t i = 0; i < std::min(joints.size(), most_curves); ++i)
    text += fmt::format("      <curve name=\"{}\" color=\"{}\"/>\n",
                        escaped(fmt::format("{}/{}/{}", topic, joints[i], quantity)), colors[i % std::size(colors)]);
  return text + "     </plot>\n    </DockArea>\n";
}

std::string layout_xml(const Shown& shown) {
  std::string tabs;
  for (const ScenarioBody& body : shown.scenario.bodies) {
    const std::vector<std::string> joints = joint_names(body);
    const std::string topic = "/" + body.name + "/joints";
    if (joints.empty() || !shown.has(topic)) continue;
    std::vector<std::string> areas{dock_area(topic, "position", joints), dock_area(topic, "velocity", joints)};
    for (const ScenarioController& controller : body.controllers)
      if (const std::string output = fmt::format("/{}/{}/output/joints", body.name, controller.name); shown.has(output))
        areas.push_back(dock_area(output, "effort", joints));
    std::string sizes, all;
    for (const std::string& area : areas) {
      sizes += fmt::format("{}{:.6g}", sizes.empty() ? "" : ";", 1.0 / static_cast<double>(areas.size()));
      all += area;
    }
    tabs += fmt::format(
        "  <Tab containers=\"1\" tab_name=\"{}\">\n   <Container>\n    <DockSplitter orientation=\"-\" count=\"{}\" "
        "sizes=\"{}\">\n{}    </DockSplitter>\n   </Container>\n  </Tab>\n",
        escaped(body.name), areas.size(), sizes, all);
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<root>\n <tabbed_widget name=\"Main Window\" "
      "parent=\"main_window\">\n"
      "{}  <currentTabIndex index=\"0\"/>\n </tabbed_widget>\n <use_relative_time_offset enabled=\"1\"/>\n</root>\n",
      tabs);
}

Result<void> write_text(const fs::path& file, std::string_view text) {
  return write_file(file, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace

Result<void> write_layout(const fs::path& trace, const fs::path& file) {
  const fs::path form = file.extension();
  if (form != ".json" && form != ".xml")
    return error_in(file.string(), "the form of a layout follows from the file's name",
                    "expected .json for Foxglove and Lichtblick, .xml for PlotJuggler");
  const auto shown = REHEARSE_TRY(contents_of(trace));
  return write_text(file, form == ".json" ? layout_json(shown) : layout_xml(shown));
}

Result<std::vector<fs::path>> export_robot(const fs::path& trace, const fs::path& folder) {
  const auto log = REHEARSE_TRY(mcap::Reader::open(trace));
  REHEARSE_TRY(scenario_of(*log));
  REHEARSE_TRY(make_folder(folder));
  std::vector<fs::path> files;
  std::set<std::string> names;
  std::string meshes;
  for (const mcap::Attachment& attachment : log->attachments()) {
    constexpr std::string_view of_meshes = ".meshes";
    if (attachment.name.ends_with(of_meshes)) {
      meshes += fmt::format("# {}: hash, file\n{}",
                            attachment.name.substr(0, attachment.name.size() - of_meshes.size()), attachment.text());
      continue;
    }
    if (attachment.name.ends_with(".report")) continue;
    std::string name = fs::path(attachment.name).filename().string();
    for (int i = 2; !names.insert(name).second; ++i)
      name = fmt::format("{}_{}{}", fs::path(attachment.name).stem().string(), i,
                         fs::path(attachment.name).extension().string());
    files.push_back(folder / name);
    REHEARSE_TRY(write_text(files.back(), attachment.text()));
  }
  if (meshes.empty()) return files;
  files.push_back(folder / "meshes.txt");
  REHEARSE_TRY(write_text(files.back(), meshes));
  return files;
}

}  // namespace rehearse
