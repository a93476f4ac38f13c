#include <rehearse/mjcf.h>

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "base/text.h"

namespace rehearse {
namespace {

using tinyxml2::XMLElement;

using Attributes = std::map<std::string, std::string>;

/// The attributes that a class states, by the name of the element.
using DefaultClass = std::map<std::string, Attributes>;

constexpr int most_includes = 100;

class DriveReader {
 public:
  Result<std::vector<MjcfDrive>> read(const std::filesystem::path& file);

 private:
  struct Document {
    std::string name;
    std::unique_ptr<tinyxml2::XMLDocument> xml;
  };
  /// An element with the attributes of its class.
  struct Described {
    const XMLElement& element;
    const Attributes* defaults = nullptr;
  };

  void open(const std::filesystem::path& file, const std::string& included_by, int line);
  void find_includes(const XMLElement& element, const std::filesystem::path& folder);
  void read_defaults(const XMLElement& element, const DefaultClass& outer, bool is_root);
  void read_body(const XMLElement& body, std::string childclass);
  void read_joint(const XMLElement& joint, const std::string& childclass);
  void read_actuator(const XMLElement& actuator);
  Described described(const XMLElement& element, const std::string& childclass) const;
  std::vector<double> numbers(const Described& of, const char* attribute);
  std::optional<double> number(const Described& of, const char* attribute);
  std::optional<double> largest(const Described& of, const char* range);
  void fail(const XMLElement& at, std::string message, std::string hint);

  std::vector<Document> documents_;
  std::map<std::string, DefaultClass> classes_;
  std::vector<MjcfDrive> drives_;
  Diagnostics errors_;
};

std::string attribute_of(const XMLElement& element, const char* name) {
  const char* text = element.Attribute(name);
  return text ? text : "";
}

void DriveReader::fail(const XMLElement& at, std::string message, std::string hint) {
  Diagnostic finding = error(std::move(message), std::move(hint));
  for (const Document& document : documents_)
    if (document.xml.get() == at.GetDocument()) finding.file = document.name;
  finding.line = at.GetLineNum();
  errors_.push_back(std::move(finding));
}

void DriveReader::open(const std::filesystem::path& file, const std::string& included_by, int line) {
  const auto refuse = [&](std::string message, std::string hint, int at) {
    Diagnostic finding = error_in(file.string(), std::move(message), std::move(hint));
    finding.line = at;
    if (!included_by.empty()) finding.hint += fmt::format(" (included by {}:{})", included_by, line);
    errors_.push_back(std::move(finding));
  };
  if (documents_.size() >= most_includes)
    return refuse("too many files are included", fmt::format("expected at most {}", most_includes), 0);
  auto xml = std::make_unique<tinyxml2::XMLDocument>();
  if (xml->LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS)
    return refuse(fmt::format("it can't be read as XML ({})", xml->ErrorName()), "expected a MuJoCo model",
                  xml->ErrorLineNum());
  const XMLElement* root = xml->RootElement();
  const std::string_view name = root ? root->Name() : "";
  if (name != "mujoco" && (included_by.empty() || name != "mujocoinclude"))
    return refuse(fmt::format("its root is <{}>", name), "expected a MuJoCo model, <mujoco>",
                  root ? root->GetLineNum() : 0);
  documents_.push_back({file.string(), std::move(xml)});
  find_includes(*root, file.parent_path());
}

void DriveReader::find_includes(const XMLElement& element, const std::filesystem::path& folder) {
  const std::string file = documents_.back().name;
  for (const XMLElement* child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) == "include")
      open(folder / attribute_of(*child, "file"), file, child->GetLineNum());
    else
      find_includes(*child, folder);
  }
}

void DriveReader::read_defaults(const XMLElement& element, const DefaultClass& outer, bool is_root) {
  DefaultClass own = outer;
  std::string name = attribute_of(element, "class");
  if (name.empty() && is_root) name = "main";
  if (is_root && classes_.count(name)) own = classes_[name];
  for (const XMLElement* child = element.FirstChildElement(); child; child = child->NextSiblingElement())
    for (const auto* attribute = child->FirstAttribute(); attribute; attribute = attribute->Next())
      if (std::string_view(child->Name()) != "default") own[child->Name()][attribute->Name()] = attribute->Value();
  if (name.empty()) return fail(element, "a class of defaults has no name", "class names it");
  classes_[name] = own;
  for (const XMLElement* child = element.FirstChildElement("default"); child;
       child = child->NextSiblingElement("default"))
    read_defaults(*child, own, false);
}

DriveReader::Described DriveReader::described(const XMLElement& element, const std::string& childclass) const {
  Described found{element};
  std::string name = attribute_of(element, "class");
  if (name.empty()) name = childclass.empty() ? "main" : childclass;
  if (const auto of_class = classes_.find(name); of_class != classes_.end())
    if (const auto defaults = of_class->second.find(element.Name()); defaults != of_class->second.end())
      found.defaults = &defaults->second;
  return found;
}

/// None, with an error, if any is no number.
std::vector<double> DriveReader::numbers(const Described& of, const char* attribute) {
  std::string text = attribute_of(of.element, attribute);
  if (text.empty() && of.defaults)
    if (const auto found = of.defaults->find(attribute); found != of.defaults->end()) text = found->second;
  std::vector<double> values;
  std::string_view rest = text;
  constexpr std::string_view blanks = " \t\r\n";
  while ((rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size())), !rest.empty())) {
    const std::string_view word = rest.substr(0, rest.find_first_of(blanks));
    const auto value = number_in<double>(word);
    if (!value || !std::isfinite(*value)) {
      fail(of.element, fmt::format("{} of <{}> is '{}'", attribute, of.element.Name(), text), "expected numbers");
      return {};
    }
    values.push_back(*value);
    rest.remove_prefix(word.size());
  }
  return values;
}

std::optional<double> DriveReader::number(const Described& of, const char* attribute) {
  const std::vector<double> values = numbers(of, attribute);
  return values.empty() ? std::nullopt : std::optional(values.front());
}

/// The largest magnitude of a range that limits anything.
std::optional<double> DriveReader::largest(const Described& of, const char* range) {
  const std::vector<double> values = numbers(of, range);
  if (values.size() != 2 || values[0] >= values[1]) return std::nullopt;
  return std::max(std::abs(values[0]), std::abs(values[1]));
}

std::optional<double> without_zero(std::optional<double> value) {
  return value && *value != 0.0 ? value : std::nullopt;
}

std::optional<double> smaller(std::optional<double> one, std::optional<double> other) {
  return one && other ? std::min(*one, *other) : one ? one : other;
}

void DriveReader::read_joint(const XMLElement& joint, const std::string& childclass) {
  const Described of = described(joint, childclass);
  std::string type = attribute_of(joint, "type");
  if (type.empty() && of.defaults && of.defaults->count("type")) type = of.defaults->at("type");
  const std::string name = attribute_of(joint, "name");
  if (name.empty() || type == "free" || type == "ball") return;
  MjcfDrive& drive = drives_.emplace_back();
  drive.joint = name;
  drive.damping = without_zero(number(of, "damping"));
  drive.coulomb = without_zero(number(of, "frictionloss"));
  drive.armature = without_zero(number(of, "armature"));
  drive.effort = largest(of, "actuatorfrcrange");
}

void DriveReader::read_body(const XMLElement& body, std::string childclass) {
  if (const std::string own = attribute_of(body, "childclass"); !own.empty()) childclass = own;
  for (const XMLElement* child = body.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string_view name = child->Name();
    if (name == "joint") read_joint(*child, childclass);
    if (name == "body" || name == "frame") read_body(*child, childclass);
  }
}

void DriveReader::read_actuator(const XMLElement& actuator) {
  const std::string name = attribute_of(actuator, "joint");
  if (name.empty()) return;  // of a tendon or a site
  const auto found = std::ranges::find_if(drives_, [&](const MjcfDrive& drive) { return drive.joint == name; });
  if (found == drives_.end())
    return fail(actuator, fmt::format("an actuator drives joint '{}', which the model lacks", name),
                "joint names a hinge or a slide of <worldbody>");
  const Described of = described(actuator, "");
  const double gear = number(of, "gear").value_or(1.0), squared = gear * gear;
  const std::string_view kind = actuator.Name();
  std::optional<double> force = largest(of, "forcerange");
  if (kind == "motor") force = smaller(force, largest(of, "ctrlrange"));
  if (force) found->effort = smaller(found->effort, std::abs(gear) * *force);
  if (kind == "position") {
    found->position_gain = squared * number(of, "kp").value_or(1.0);
    if (const auto kv = without_zero(number(of, "kv"))) found->velocity_gain = squared * *kv;
  } else if (kind == "velocity") {
    found->velocity_gain = squared * number(of, "kv").value_or(1.0);
  } else if (kind == "general") {
    const std::vector<double> bias = numbers(of, "biasprm");
    if (bias.size() > 1 && bias[1] != 0.0) found->position_gain = -squared * bias[1];
    if (bias.size() > 2 && bias[2] != 0.0) found->velocity_gain = -squared * bias[2];
  }
}

Result<std::vector<MjcfDrive>> DriveReader::read(const std::filesystem::path& file) {
  open(file, "", 0);
  const auto each = [&](const char* section, const auto& use) {
    for (const Document& document : documents_)
      for (const XMLElement* found = document.xml->RootElement()->FirstChildElement(section); found;
           found = found->NextSiblingElement(section))
        use(*found);
  };
  each("default", [&](const XMLElement& found) { read_defaults(found, {}, true); });
  each("worldbody", [&](const XMLElement& found) { read_body(found, ""); });
  each("actuator", [&](const XMLElement& found) {
    for (const XMLElement* child = found.FirstChildElement(); child; child = child->NextSiblingElement())
      if (std::string_view(child->Name()) != "include") read_actuator(*child);
  });
  if (!errors_.empty()) return errors_;
  return std::move(drives_);
}

}  // namespace

Result<std::vector<MjcfDrive>> load_mjcf_drives(const std::filesystem::path& file) { return DriveReader().read(file); }

}  // namespace rehearse
