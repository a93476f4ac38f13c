#include <rehearse/urdf.h>

#include "known_robots.h"
#include "urdf_draft.h"
#include "urdf_materials.h"
#include "urdf_meshes.h"
#include "urdf_schema.h"
#include "urdf_text.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <locale>
#include <sstream>
#include <system_error>

namespace rehearse {
namespace {

using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;
using urdf::Findings;

/// The version of the URDF format, not of the robot.
void check_version(const XMLElement& robot, Findings& findings) {
  const char* text = robot.Attribute("version");
  const std::string_view version = text == nullptr ? "1.0" : text;
  if (version == "1.0" || version == "1" || version == "1.1") return;
  findings.warning(robot.GetLineNum(),
                   fmt::format("the file is of URDF version {}; it is read as 1.1", in_quotes(version)));
}

/// The robot's name; if it has none, the name of its file, which urdfdom needs in the document.
std::string read_robot_name(XMLElement& robot, const std::filesystem::path& file, Findings& findings) {
  const char* text = robot.Attribute("name");
  const std::string of_file = file.stem().string();
  if ((text == nullptr || *text == '\0') && !of_file.empty()) {
    findings.repair(robot.GetLineNum(),
                    fmt::format("the robot has no name; it gets that of its file, {}", in_quotes(of_file)));
    robot.SetAttribute("name", of_file.c_str());
  }
  return urdf::read_name(robot, "name", findings).value_or("");
}

/// Everything that Rehearse's own reader reads of the robot; it also prepares the document for urdfdom.
urdf::Draft read_draft(XMLElement& robot, const std::filesystem::path& file, urdf::Meshes& meshes, Findings& findings) {
  urdf::Draft draft;
  draft.name = read_robot_name(robot, file, findings);
  urdf::prune_to_schema(robot, findings);
  check_version(robot, findings);
  draft.rotors = urdf::read_transmissions(robot, findings);
  draft.springs = urdf::read_springs(robot, findings);
  draft.loops = urdf::read_loops(robot, findings);
  urdf::read_surfaces(robot, draft, findings);
  draft.devices = urdf::read_devices(robot, findings);
  draft.tracks = urdf::read_tracks(robot, findings);
  const urdf::Materials materials(robot, meshes, findings);
  for (auto* link = robot.FirstChildElement("link"); link != nullptr; link = link->NextSiblingElement("link")) {
    auto read = urdf::read_link(*link, materials, meshes, findings);
    draft.is_complete = draft.is_complete && read.has_value();
    if (read) draft.links.push_back(std::move(*read));
  }
  for (auto* joint = robot.FirstChildElement("joint"); joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    auto read = urdf::read_joint(*joint, findings);
    draft.is_complete = draft.is_complete && read.has_value();
    if (read) draft.joints.push_back(std::move(*read));
  }
  urdf::declare_world(robot, draft, findings);
  return draft;
}

/// Writes single blanks between numbers and none around them: urdfdom accepts no other form.
void straighten_blanks(XMLElement& element) {
  for (const auto* attribute = element.FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
    const std::string_view name = attribute->Name();
    if (name == "name" || name == "type" || name == "link" || name == "filename") continue;
    std::istringstream words(attribute->Value());
    words.imbue(std::locale::classic());
    std::string straight;
    for (std::string word; words >> word;) straight += (straight.empty() ? "" : " ") + word;
    element.SetAttribute(attribute->Name(), straight.c_str());
  }
}

/// True for elements that only Rehearse's own reader reads.
bool is_ours_alone(std::string_view element) {
  for (const char* name : {"gazebo", "sensor", "transmission", "material", "contact", "loop_joint"}) {
    if (element == name) return true;
  }
  return false;
}

/// urdfdom doesn't read quaternions.
void write_as_rpy(const Eigen::Matrix3d& rotation, XMLElement& origin) {
  const Eigen::Vector3d rpy = urdf::rpy_from_rotation(rotation);
  origin.DeleteAttribute("quat_xyzw");
  origin.SetAttribute("rpy", fmt::format("{} {} {}", rpy.x(), rpy.y(), rpy.z()).c_str());
}

/// Removes elements that urdfdom reads wrongly or not at all, and writes the rest in the form that urdfdom accepts.
void prepare_for_urdfdom(XMLElement& element) {
  straighten_blanks(element);
  element.DeleteAttribute("version");
  if (auto* origin = element.FirstChildElement("origin"); origin && origin->Attribute("quat_xyzw") != nullptr) {
    Findings told_before("", false);
    write_as_rpy(urdf::read_origin(element, told_before).linear(), *origin);
  }
  XMLElement* next = nullptr;
  for (XMLElement* child = element.FirstChildElement(); child != nullptr; child = next) {
    next = child->NextSiblingElement();
    if (is_ours_alone(child->Name())) {
      element.DeleteChild(child);
    } else {
      prepare_for_urdfdom(*child);
    }
  }
}

bool has_broken_inertial(const urdf::Draft& draft) {
  return std::ranges::any_of(draft.links, [](const urdf::LinkDraft& link) { return link.has_broken_inertial; });
}

/// Reads the robot from a text that passed the first checks; nullopt if there is an error.
std::optional<Model> read_robot(const std::string& text, const std::filesystem::path& file, const UrdfOptions& options,
                                urdf::Meshes& meshes, Findings& findings) {
  XMLDocument document;
  XMLElement* robot = urdf::parse_xml(text, document, findings);
  if (robot == nullptr) return std::nullopt;
  const urdf::Draft draft = read_draft(*robot, file, meshes, findings);
  if (draft.links.size() > max_urdf_links) {
    findings.error(0, fmt::format("the robot has {} links, more than {}", draft.links.size(), max_urdf_links));
    return std::nullopt;
  }
  std::optional<Model> model = urdf::join(draft, findings);
  if (model && !has_broken_inertial(draft)) {
    urdf::complete_masses(*model, options, findings);
    urdf::repair_inertias(*model, options, findings);
    urdf::check_dynamics(*model, options, findings);
    meshes.prepare_contacts(*model);
    urdf::check_mesh_up(*model, options, findings);
  }
  if (findings.has_error()) return std::nullopt;
  if (!options.compare) return model;
  prepare_for_urdfdom(*robot);
  urdf::compare_with_urdfdom(document, draft, findings);
  return model;
}

}  // namespace

Result<Model> load_urdf(const std::filesystem::path& file, const UrdfOptions& options) {
  std::error_code problem;
  const auto status = std::filesystem::status(file, problem);
  if (!std::filesystem::exists(status)) return error_in(file.string(), "there is no such file");
  if (!std::filesystem::is_regular_file(status)) return error_in(file.string(), "this is not a file that can be read");
  const auto size = std::filesystem::file_size(file, problem);
  if (!problem && size > max_urdf_bytes) {
    return error_in(file.string(), fmt::format("the file has {} bytes, more than {} MiB", size, max_urdf_bytes >> 20));
  }
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad()) return error_in(file.string(), "the file can't be read");
  return parse_urdf(text, file.string(), options);
}

Result<Model> parse_urdf(const std::string& text, const std::string& name, const UrdfOptions& options) {
  REHEARSE_ASSERT(options.default_mass.value_or(1.0) > 0.0, "a default mass is above 0");
  auto& known = urdf::KnownRobots::of_process();
  const bool can_keep = known.can_keep(text, options);
  if (can_keep)
    if (auto robot = known.find(text, name, options)) return *std::move(robot);
  urdf::count_robot();
  Findings findings(name, options.strict);
  urdf::Meshes meshes(name, options, findings);
  std::optional<Model> model;
  if (urdf::text_is_sound(text, findings)) model = read_robot(text, name, options, meshes, findings);
  if (findings.has_error()) return findings.errors();
  REHEARSE_ASSERT(model.has_value(), "a robot that can't be read has an error");
  model->source_file = name;
  model->source_text = text;
  model->report = findings.report();
  if (can_keep) known.keep(*model, options);
  return std::move(*model);
}

}  // namespace rehearse
