#include "mjcf_elements.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/names.h"
#include "urdf/urdf_text.h"
#include "urdf/urdf_values.h"

namespace rehearse::mjcf {
namespace {

/// Attributes of an element, by blanks: those that are read, and those without effect here. The rest are unknown.
struct Known {
  const char* element;
  const char* read;
  const char* ignored;
};

constexpr const char* place_attributes = " name class pos quat axisangle xyaxes zaxis euler user ";

const Known known_attributes[] = {
    {"body", "childclass mocap gravcomp", "sleep"},
    {"joint",
     "type axis limited stiffness range actuatorfrcrange actuatorfrclimited ref springref armature damping "
     "frictionloss springdamper actuatorgravcomp",
     "group margin solreflimit solimplimit solreffriction solimpfriction limitedfriction solimpfix solreffix"},
    {"freejoint", "", "group align"},
    {"geom",
     "type contype conaffinity condim group size material friction mass density shellinertia rgba fromto hfield mesh "
     "fitscale",
     "priority solmix solref solimp margin gap fluidshape fluidcoef"},
    {"site", "type group size material rgba fromto", ""},
    {"inertial", "mass diaginertia fullinertia", ""},
    {"camera", "fovy resolution mode target",
     "ipd focal focalpixel principal principalpixel sensorsize orthographic output projection"},
    {"mesh", "file vertex face scale refpos refquat inertia",
     "content_type smoothnormal maxhullvert normal texcoord material octree_maxdepth"},
    {"material", "rgba texture", "emission specular shininess reflectance metallic roughness texrepeat texuniform"},
    {"frame", "childclass", ""},
};

bool has_word(std::string_view list, std::string_view word) {
  for (std::size_t at = list.find(word); at != std::string_view::npos; at = list.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || list[at - 1] == ' ') && (end == list.size() || list[end] == ' ')) return true;
  }
  return false;
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  while ((text.remove_prefix(std::min(text.find_first_not_of(' '), text.size())), !text.empty())) {
    words.emplace_back(text.substr(0, text.find(' ')));
    text.remove_prefix(words.back().size());
  }
  return words;
}

/// The kinds of actuators have one set of defaults.
const char* shared_kind(const char* kind) { return is_actuator(kind) ? "actuator" : kind; }

}  // namespace

bool is_actuator(std::string_view kind) {
  return urdf::is_one_of(
      kind, {"general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion"});
}

void check_attributes(Files& files, const XMLElement& element) {
  const std::string_view kind = element.Name();
  const auto known = std::ranges::find_if(known_attributes, [&](const Known& each) { return kind == each.element; });
  if (known == std::end(known_attributes)) return;
  for (const auto* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next()) {
    const std::string_view name = attribute->Name();
    if (has_word(known->read, name) || has_word(place_attributes, name)) continue;
    if (has_word(known->ignored, name)) {
      if (name != "group") files.ignored(element, fmt::format("the attribute {} of {}", name, urdf::tag(kind)));
      continue;
    }
    const std::string all = std::string(place_attributes) + known->read + " " + known->ignored;
    files.warning(element, fmt::format("{} has no attribute {}", urdf::tag(kind), in_quotes(name)),
                  name_hint(name, words_of(all), "attributes"));
  }
}

std::string_view Element::kind() const { return xml_.Name(); }

std::optional<std::string> Element::text(const char* attribute) const {
  if (const char* own = xml_.Attribute(attribute)) return own;
  if (defaults_ == nullptr) return std::nullopt;
  const auto found = defaults_->find(attribute);
  return found == defaults_->end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::vector<double>> Element::numbers(const char* attribute, std::size_t least, std::size_t most) const {
  const auto written = text(attribute);
  if (!written) return std::nullopt;
  std::vector<double> values;
  std::string_view rest = *written;
  while ((rest.remove_prefix(std::min(rest.find_first_not_of(urdf::blanks), rest.size())), !rest.empty())) {
    const std::string_view word = rest.substr(0, rest.find_first_of(urdf::blanks));
    const auto value = urdf::parse_number(word);
    if (!value || values.size() == most) {
      const std::string count =
          least == most ? count_text(least, "number") : fmt::format("{} to {} numbers", least, most);
      error(fmt::format("{} of {} is {}", attribute, urdf::tag(kind()), in_quotes(*written)),
            value ? "expected " + count : "expected numbers");
      return std::nullopt;
    }
    values.push_back(*value);
    rest.remove_prefix(word.size());
  }
  if (values.size() >= least) return values;
  error(fmt::format("{} of {} is {}", attribute, urdf::tag(kind()), in_quotes(*written)),
        "expected at least " + count_text(least, "number"));
  return std::nullopt;
}

std::optional<double> Element::number(const char* attribute) const {
  const auto values = numbers(attribute, 1, 1);
  return values ? std::optional(values->front()) : std::nullopt;
}

std::optional<Eigen::Vector3d> Element::vector(const char* attribute) const {
  const auto values = numbers(attribute, 3, 3);
  if (!values) return std::nullopt;
  return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

int Element::mask(const char* attribute, int otherwise) const {
  const auto value = number(attribute);
  if (!value) return otherwise;
  if (*value >= 0.0 && *value <= 2147483647.0 && *value == std::floor(*value)) return static_cast<int>(*value);
  error(fmt::format("{} of {} is {}", attribute, urdf::tag(kind()), in_quotes(*text(attribute))),
        "expected a whole number of at least 0");
  return otherwise;
}

std::optional<bool> Element::flag(const char* attribute) const {
  const auto written = text(attribute);
  if (!written || *written == "auto") return std::nullopt;
  if (*written == "true" || *written == "false") return *written == "true";
  error(fmt::format("{} of {} is {}", attribute, urdf::tag(kind()), in_quotes(*written)),
        "expected true, false or auto");
  return std::nullopt;
}

Eigen::Matrix3d rotation_of_z(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d to = direction.normalized();
  const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(to);
  const double sine = across.norm();
  const Eigen::Vector3d axis = sine < 1e-10 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d(across / sine);
  return Eigen::AngleAxisd(std::atan2(sine, to.z()), axis).toRotationMatrix();
}

Eigen::Matrix3d Element::rotation(const Compiler& compiler) const {
  constexpr double least = 1e-10;
  constexpr const char* forms[] = {"quat", "axisangle", "xyaxes", "zaxis", "euler"};
  const Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
  const char* form = nullptr;
  for (const char* each : forms) {  // an orientation of the element replaces that of its class
    if (xml_.Attribute(each) == nullptr) continue;
    if (form != nullptr) {
      error(fmt::format("{} has both {} and {}", urdf::tag(kind()), form, each), "give one orientation");
      return none;
    }
    form = each;
  }
  for (const char* each : forms)
    if (form == nullptr && states(each)) form = each;
  if (form == nullptr) return none;
  const std::string_view name = form;
  const std::size_t count = name == "xyaxes" ? 6 : name == "quat" || name == "axisangle" ? 4 : 3;
  const auto v = numbers(form, count, count);
  if (!v) return none;
  const auto refuse = [&] {
    error(fmt::format("{} of {} is {}, which is no direction", form, urdf::tag(kind()), in_quotes(*text(form))),
          "expected a length above 0");
    return none;
  };
  if (name == "quat") {
    const Eigen::Quaterniond quaternion((*v)[0], (*v)[1], (*v)[2], (*v)[3]);
    return quaternion.norm() > least ? quaternion.normalized().toRotationMatrix() : refuse();
  }
  const Eigen::Vector3d first((*v)[0], (*v)[1], (*v)[2]);
  if (name == "axisangle") {
    if (!(first.norm() > least)) return refuse();
    return Eigen::AngleAxisd(compiler.radians((*v)[3]), first.normalized()).toRotationMatrix();
  }
  if (name == "zaxis") return first.norm() > least ? rotation_of_z(first) : refuse();
  if (name == "xyaxes") {
    if (!(first.norm() > least)) return refuse();
    const Eigen::Vector3d x = first.normalized(), given((*v)[3], (*v)[4], (*v)[5]);
    const Eigen::Vector3d y = given - x * x.dot(given);
    if (!(y.norm() > least)) return refuse();
    Eigen::Matrix3d rotation;
    rotation << x, y.normalized(), x.cross(y.normalized());
    return rotation;
  }
  Eigen::Matrix3d rotation = none;
  for (std::size_t i = 0; i < 3; ++i) {
    const char letter = compiler.euler_order[i];
    const bool turns_with = letter >= 'x';
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(letter - (turns_with ? 'x' : 'X'));
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(compiler.radians((*v)[i]), axis).toRotationMatrix();
    rotation = turns_with ? Eigen::Matrix3d(rotation * turn) : Eigen::Matrix3d(turn * rotation);
  }
  return rotation;
}

Eigen::Isometry3d Element::pose(const Compiler& compiler) const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = vector("pos").value_or(Eigen::Vector3d::Zero());
  pose.linear() = rotation(compiler);
  return pose;
}

std::optional<std::array<double, 2>> Element::range(const char* attribute, const char* limited,
                                                    const Compiler& compiler) const {
  const auto values = numbers(attribute, 2, 2);
  const auto is_limited = flag(limited);
  if (is_limited == false || (!is_limited && !compiler.auto_limits) || !values) {
    if (is_limited == true && !states(attribute))
      error(fmt::format("{} is limited without a {}", urdf::tag(kind()), attribute),
            fmt::format("{}=\"-1 1\"", attribute));
    return std::nullopt;
  }
  if ((*values)[0] < (*values)[1]) return std::array<double, 2>{(*values)[0], (*values)[1]};
  if ((*values)[0] != 0.0 || (*values)[1] != 0.0)
    error(fmt::format("{} of {} is {}", attribute, urdf::tag(kind()), in_quotes(*text(attribute))),
          "expected the lower limit, then a larger one");
  return std::nullopt;
}

void Classes::read_class(const XMLElement& element, const DefaultClass& outer, bool is_root) {
  DefaultClass own = outer;
  const char* written = element.Attribute("class");
  std::string name = written ? written : "";
  if (name.empty() && is_root) name = "main";
  if (is_root && classes_.count(name)) own = classes_[name];
  if (name.empty()) return files_.error(element, "a class of defaults has no name", "class=\"NAME\"");
  if (!is_root && classes_.count(name))
    return files_.error(element, fmt::format("a second class of defaults has the name {}", in_quotes(name)),
                        "give each class a name of its own");
  const std::vector<const XMLElement*> children = files_.children(element);
  for (const XMLElement* child : children) {
    if (std::string_view(child->Name()) == "default") continue;
    check_attributes(files_, *child);
    for (const auto* attribute = child->FirstAttribute(); attribute; attribute = attribute->Next())
      own[shared_kind(child->Name())][attribute->Name()] = attribute->Value();
  }
  classes_[name] = own;
  for (const XMLElement* child : children)
    if (std::string_view(child->Name()) == "default") read_class(*child, own, false);
}

void Classes::read() {
  for (const XMLElement* section : files_.children(*files_.root()))
    if (std::string_view(section->Name()) == "default") read_class(*section, {}, true);
}

Element Classes::described(const XMLElement& element, const std::string& childclass) const {
  const char* written = element.Attribute("class");
  const std::string name = written ? written : childclass.empty() ? "main" : childclass;
  const auto of_class = classes_.find(name);
  if (of_class == classes_.end()) {
    if (name != "main") {
      std::vector<std::string> names;
      for (const auto& [each, ignored] : classes_) names.push_back(printable(each));
      files_.error(element, fmt::format("the class {} of {} isn't there", in_quotes(name), urdf::tag(element.Name())),
                   name_hint(name, names, "classes"));
    }
    return Element(files_, element, nullptr);
  }
  const auto defaults = of_class->second.find(shared_kind(element.Name()));
  return Element(files_, element, defaults == of_class->second.end() ? nullptr : &defaults->second);
}

Compiler read_compiler(Files& files) {
  Compiler compiler;
  for (const XMLElement* xml : files.children(*files.root())) {
    if (std::string_view(xml->Name()) != "compiler") continue;
    const Element element(files, *xml, nullptr);
    const auto word = [&](const char* attribute, std::initializer_list<std::string_view> words) {
      const auto text = element.text(attribute);
      if (!text || urdf::is_one_of(*text, words)) return text;
      std::string all;
      for (const std::string_view each : words) all += (all.empty() ? "" : " or ") + std::string(each);
      element.error(fmt::format("{} of <compiler> is {}", attribute, in_quotes(*text)), "expected " + all);
      return std::optional<std::string>();
    };
    if (const auto angle = word("angle", {"degree", "radian"})) compiler.degrees = *angle == "degree";
    if (word("coordinate", {"local", "global"}) == "global")
      element.error("coordinate of <compiler> is 'global'", "MuJoCo 2.3.1 saves the file with local coordinates");
    if (const auto order = element.text("eulerseq")) {
      const bool is_order = order->size() == 3 && order->find_first_not_of("xyzXYZ") == std::string::npos;
      if (is_order)
        compiler.euler_order = *order;
      else
        element.error(fmt::format("eulerseq of <compiler> is {}", in_quotes(*order)), "expected three of x y z X Y Z");
    }
    for (const char* folder : {"assetdir", "meshdir"})
      if (const auto text = element.text(folder)) compiler.mesh_folder = *text;
    compiler.strips_paths = element.flag("strippath").value_or(compiler.strips_paths);
    compiler.auto_limits = element.flag("autolimits").value_or(compiler.auto_limits);
    compiler.discards_visual = element.flag("discardvisual").value_or(compiler.discards_visual);
    compiler.exact_inertia = element.flag("exactmeshinertia").value_or(compiler.exact_inertia);
    compiler.balances_inertia = element.flag("balanceinertia").value_or(compiler.balances_inertia);
    if (element.states("inertiafromgeom")) compiler.inertia_from_geoms = element.flag("inertiafromgeom");
    if (const auto groups = element.numbers("inertiagrouprange", 2, 2))
      compiler.inertia_groups = {(*groups)[0], (*groups)[1]};
    compiler.least_mass = element.number("boundmass").value_or(compiler.least_mass);
    compiler.least_inertia = element.number("boundinertia").value_or(compiler.least_inertia);
    compiler.whole_mass = element.number("settotalmass").value_or(compiler.whole_mass);
  }
  return compiler;
}

}  // namespace rehearse::mjcf
