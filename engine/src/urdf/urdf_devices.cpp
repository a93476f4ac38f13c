#include "urdf_devices.h"

#include "urdf_draft.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string_view>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

std::optional<DeviceKind> kind_of_sensor(std::string_view type) {
  if (const auto kind = device_kind_of_urdf(type)) return kind;
  Camera camera;
  camera.depth = type == "depth" || type == "depth_camera" || type == "rgbd" || type == "rgbd_camera";
  if (camera.depth || type == "camera" || type == "multicamera") return camera;
  return std::nullopt;
}

/// The <camera> whose <image>, or the <ray> whose <horizontal>, has attributes in a sensor of <robot>; or null.
const XMLElement* find_optical(const XMLElement& sensor, const char* what, const char* figures) {
  const XMLElement* element = sensor.FirstChildElement(what);
  const XMLElement* inner = element == nullptr ? nullptr : element->FirstChildElement(figures);
  return inner != nullptr && inner->FirstAttribute() != nullptr ? element : nullptr;
}

const XMLElement* find_optical_camera(const XMLElement& sensor) { return find_optical(sensor, "camera", "image"); }
const XMLElement* find_optical_ray(const XMLElement& sensor) { return find_optical(sensor, "ray", "horizontal"); }

int read_id(const XMLElement& sensor, Findings& findings) {
  const XMLElement* element = sensor.FirstChildElement("id");
  if (element == nullptr) return -1;
  const auto value = read_text_number(*element, findings);
  if (!value) return -1;
  constexpr double most = 1e6;
  if (*value < 0.0 || *value > most || *value != std::floor(*value)) {
    findings.error(element->GetLineNum(), fmt::format("the id {} isn't a whole number from 0 to {}", *value, most));
    return -1;
  }
  return static_cast<int>(*value);
}

std::optional<DeviceKind> kind_of(const XMLElement& element) {
  const char* text = element.Attribute("type");
  const std::string_view type = text == nullptr ? "" : text;
  if (std::string_view(element.Name()) == "light") {
    if (const auto light = light_of_type(type)) return *light;
    return std::nullopt;
  }
  if (std::string_view(element.Name()) == "rotor") return Rotor{};
  if (std::string_view(element.Name()) == "holder") return Holder{};
  if (text == nullptr && find_optical_camera(element) != nullptr) return Camera{};
  if (text == nullptr && find_optical_ray(element) != nullptr) return RangeSensor{};
  return kind_of_sensor(type);
}

/// True for a sensor that is not in a <gazebo> block.
bool is_of_robot(const XMLElement& element) {
  return std::string_view(element.Parent()->ToElement()->Name()) == "robot";
}

/// The known children of a sensor: the common ones and those of its kind.
std::vector<std::string_view> known_children(const XMLElement& element, std::vector<std::string_view> of_kind) {
  of_kind.insert(of_kind.end(), {"id", "pose"});
  if (is_of_robot(element)) of_kind.insert(of_kind.end(), {"parent", "origin"});
  return of_kind;
}

std::string name_or(const XMLElement& element, const std::string& fallback, Findings& findings) {
  const char* name = element.Attribute("name");
  return name == nullptr || *name == '\0' ? fallback : read_name(element, "name", findings).value_or(fallback);
}

/// Adds a camera for each <camera> of the sensor, named after both if the sensor is a multicamera.
void read_cameras(const XMLElement& sensor, const DeviceDraft& common, std::vector<DeviceDraft>& devices,
                  Findings& findings) {
  report_ignored(sensor, known_children(sensor, {"update_rate", "camera"}), findings);
  const XMLElement* element = sensor.FirstChildElement("camera");
  if (element == nullptr) {
    findings.error(sensor.GetLineNum(), fmt::format("camera {} has no <camera>", in_quotes(common.device.name)),
                   "<camera> contains the picture's size, the field of view and the clip distances");
    return;
  }
  const bool is_multiple = sensor.Attribute("type", "multicamera") != nullptr;
  for (int i = 0; element != nullptr; element = element->NextSiblingElement("camera"), ++i) {
    DeviceDraft draft = common;
    if (is_multiple) {
      draft.device.name += "_" + name_or(*element, std::to_string(i), findings);
      draft.device.line = element->GetLineNum();
      if (draft.device.id >= 0) draft.device.id += i;
    } else if (i > 0) {
      findings.error(element->GetLineNum(),
                     fmt::format("sensor {} has a second <camera>", in_quotes(common.device.name)),
                     "several belong to a sensor of type multicamera");
      return;
    }
    Camera& camera = std::get<Camera>(draft.device.kind);
    if (element == find_optical_camera(sensor)) {
      read_optical_camera(sensor, *element, camera, draft.device.pose, findings);
    } else {
      read_camera(sensor, *element, camera, draft.device.pose, findings);
    }
    devices.push_back(std::move(draft));
  }
}

void read_rotor(const XMLElement& element, Rotor& rotor, Findings& findings) {
  const XMLElement* direction = element.FirstChildElement("direction");
  const auto along = direction == nullptr ? std::nullopt : read_text_numbers(*direction, 3, findings);
  if (!along) return;
  const Eigen::Vector3d vector(along->data());
  if (vector.isZero(0.0))
    findings.error(direction->GetLineNum(), "the <direction> of a rotor is zero");
  else
    rotor.direction = vector.stableNormalized();
}

void read_holder(const XMLElement& element, Holder& holder, Findings& findings) {
  holder.max_distance = read_positive_or(&element, "max_distance", holder.max_distance, 1e6, findings);
  if (const XMLElement* target = element.FirstChildElement("target")) holder.target = text_of(*target);
  const XMLElement* condition = element.FirstChildElement("condition");
  const std::string_view text = condition == nullptr ? "distance" : text_of(*condition);
  if (text == "distance") {
    holder.condition = Holder::Condition::distance;
  } else if (text == "collision") {
    holder.condition = Holder::Condition::touch;
  } else if (text == "name") {
    holder.condition = Holder::Condition::name;
    if (holder.target.empty())
      findings.error(element.GetLineNum(), "a holder that holds by name has no <target>", "the name of a body");
  } else {
    findings.error(condition->GetLineNum(),
                   fmt::format("<condition> contains {}, not distance, collision or name", in_quotes(text)));
  }
}

void read_figures(const XMLElement& element, DeviceDraft& draft, Findings& findings) {
  Device& device = draft.device;
  std::vector<std::string_view> of_kind;
  if (auto* laser = std::get_if<RangeSensor>(&device.kind)) {
    of_kind = {"update_rate", "ray", "lidar"};
    if (const XMLElement* ray = find_optical_ray(element)) {
      read_optical_range_sensor(element, *ray, *laser, device.pose, findings);
    } else {
      read_range_sensor(element, *laser, device.pose, findings);
    }
  } else if (auto* light = std::get_if<Light>(&device.kind)) {
    return read_light(element, *light, findings);
  } else if (auto* rotor = std::get_if<Rotor>(&device.kind)) {
    of_kind = {"direction"};
    read_rotor(element, *rotor, findings);
  } else if (auto* holder = std::get_if<Holder>(&device.kind)) {
    of_kind = {"condition", "max_distance", "target"};
    read_holder(element, *holder, findings);
  } else if (std::holds_alternative<ForceSensor>(device.kind)) {
    of_kind = {"force_torque"};
    read_force_sensor(element, draft, findings);
  } else if (std::holds_alternative<ContactSensor>(device.kind)) {
    of_kind = {"contact"};
    read_contact_sensor(element, draft, findings);
  }
  report_ignored(element, known_children(element, std::move(of_kind)), findings);
}

/// Sets the sensor's or light's place: the reference of its <gazebo> block, or its <parent>. False, with an error, if
/// there is neither.
bool read_reference(const XMLElement& element, DeviceDraft& draft, Findings& findings) {
  const bool is_in_block = !is_of_robot(element);
  const XMLElement* parent = is_in_block ? element.Parent()->ToElement() : element.FirstChildElement("parent");
  const auto find = [&](const char* attribute) { return parent == nullptr ? nullptr : parent->Attribute(attribute); };
  const bool is_force = std::holds_alternative<ForceSensor>(draft.device.kind);
  if (const char* any = is_in_block ? find("reference") : nullptr) {
    draft.meaning = is_force ? Reference::joint_else_link : Reference::link_else_joint;
    draft.reference = any;
  } else if (const char* link = is_in_block ? nullptr : find("link")) {
    draft.meaning = Reference::link;
    draft.reference = link;
  } else if (const char* joint = is_in_block ? nullptr : find("joint")) {
    draft.meaning = Reference::joint;
    draft.reference = joint;
  } else {
    findings.error(element.GetLineNum(),
                   fmt::format("{} {} is on no link", element.Name(), in_quotes(draft.device.name)),
                   is_in_block ? "its <gazebo> names the link: <gazebo reference=\"LINK\">"
                               : "it names its link: <parent link=\"LINK\"/>");
    return false;
  }
  return true;
}

/// Adds the devices that a <sensor> or <light> describes; none for an unknown kind, with a note. Any error means that
/// the element can't be understood.
void read_description(const XMLElement& element, std::vector<DeviceDraft>& devices, Findings& findings) {
  const auto kind = kind_of(element);
  if (!kind) {
    const char* type = element.Attribute("type");
    findings.ignored(element.GetLineNum(), type == nullptr
                                               ? fmt::format("a {} without a type", element.Name())
                                               : fmt::format("a {} of type {}", element.Name(), in_quotes(type)));
    return;
  }
  DeviceDraft draft;
  draft.device.kind = *kind;
  draft.device.line = element.GetLineNum();
  draft.is_of_robot = is_of_robot(element);
  const auto name = read_name(element, "name", findings);
  if (!name) return;
  draft.device.name = *name;
  if (!read_reference(element, draft, findings)) return;
  draft.device.id = read_id(element, findings);
  if (is_of_robot(element)) draft.device.pose = read_origin(element, findings);
  if (const XMLElement* pose = element.FirstChildElement("pose"))
    draft.device.pose = draft.device.pose * read_text_pose(*pose, findings);
  if (std::holds_alternative<Camera>(draft.device.kind)) {
    read_cameras(element, draft, devices, findings);
  } else {
    read_figures(element, draft, findings);
    devices.push_back(std::move(draft));
  }
}

/// A description that can't be understood.
struct Unread {
  const XMLElement& element;
  std::string what;
  Findings findings;
};

/// Adds the devices of an element, or the element itself to those that can't be understood.
void read_device(const XMLElement& element, std::vector<DeviceDraft>& devices, std::vector<Unread>& unread,
                 Findings& findings) {
  const char* name = element.Attribute("name");
  const std::string what = name == nullptr || *name == '\0' ? fmt::format("a {}", element.Name())
                                                            : fmt::format("{} {}", element.Name(), in_quotes(name));
  std::vector<DeviceDraft> described;
  Findings of_element = findings.of_part();
  read_description(element, described, of_element);
  if (of_element.has_error()) return unread.push_back({element, what, std::move(of_element)});
  findings.take(of_element, what);
  devices.insert(devices.end(), std::make_move_iterator(described.begin()), std::make_move_iterator(described.end()));
}

void ignore_second_description(int line, Findings& findings) {
  findings.ignored(line, "a sensor's second description, in <robot> or <gazebo>,");
}

/// Warns of the descriptions that can't be understood, unless the other reader's description of the sensor can be.
void report_unread(const std::vector<Unread>& unread, const std::vector<DeviceDraft>& devices, Findings& findings) {
  for (const Unread& part : unread) {
    const char* name = part.element.Attribute("name");
    const bool is_known = std::ranges::any_of(devices, [&](const DeviceDraft& draft) {
      return name != nullptr && draft.device.name == name && draft.is_of_robot != is_of_robot(part.element);
    });
    if (is_known)
      ignore_second_description(part.element.GetLineNum(), findings);
    else
      findings.take(part.findings, part.what);
  }
}

/// The kinds within which ids are unique: a RangeCamera is a Camera, a SpotLight a PointLight.
std::string_view id_group(const Device& device) {
  if (std::holds_alternative<Light>(device.kind)) return "light";
  return std::holds_alternative<Camera>(device.kind) ? "camera" : type_name(device);
}

/// A robot for several simulators describes its sensors for each of them: one name, and one place or one kind.
bool are_for_two_readers(const DeviceDraft& a, const DeviceDraft& b) {
  return a.is_of_robot != b.is_of_robot && (a.reference == b.reference || type_name(a.device) == type_name(b.device));
}

/// Gives a device whose name an earlier one has a name of its own, which begins with its place as in Gazebo's scopes.
/// False if that name is taken, too.
bool rename(DeviceDraft& draft, const DeviceDraft& first, const std::set<std::string>& names, Findings& findings) {
  Device& device = draft.device;
  const std::string own = draft.reference + "_" + device.name;
  if (names.contains(own)) return false;
  const bool is_same = word_for(device) == word_for(first.device);
  findings.repair(device.line, fmt::format("a second {} with the name {}, after the one in line {}; it is called {}",
                                           is_same ? word_for(device) : "device", in_quotes(device.name),
                                           first.device.line, in_quotes(own)));
  device.name = own;
  return true;
}

/// Leaves out descriptions that repeat an earlier one, and gives other devices of one name names of their own.
void settle_names(std::vector<DeviceDraft>& devices, Findings& findings) {
  std::set<std::string> names;
  for (const DeviceDraft& draft : devices) names.insert(draft.device.name);
  std::map<std::string, std::size_t> first_of;  // by name as written
  std::vector<DeviceDraft> kept;
  kept.reserve(devices.size());
  for (DeviceDraft& draft : devices) {
    const auto [place, is_new] = first_of.emplace(draft.device.name, kept.size());
    const DeviceDraft* first = is_new ? nullptr : &kept[place->second];
    const Device& device = draft.device;
    if (first != nullptr && are_for_two_readers(*first, draft)) {
      ignore_second_description(device.line, findings);
      continue;
    }
    const bool is_repeated =
        first != nullptr && first->reference == draft.reference && type_name(first->device) == type_name(device);
    if (is_repeated || (first != nullptr && !rename(draft, *first, names, findings))) {
      findings.repair(device.line, fmt::format("a second {} {} of the same {} at the same place, after the one in line "
                                               "{}; it is left out",
                                               word_for(device), in_quotes(device.name), is_repeated ? "kind" : "name",
                                               first->device.line));
      continue;
    }
    names.insert(device.name);
    kept.push_back(std::move(draft));
  }
  devices = std::move(kept);
}

/// Takes the id from a device if an earlier one of its kind has it.
void settle_ids(std::vector<DeviceDraft>& devices, Findings& findings) {
  std::map<std::pair<std::string_view, int>, const Device*> by_id;
  for (DeviceDraft& draft : devices) {
    Device& device = draft.device;
    if (device.id < 0) continue;
    const auto [first, is_new] = by_id.emplace(std::pair(id_group(device), device.id), &device);
    if (is_new) continue;
    const std::string_view word = word_for(device);
    findings.repair(device.line,
                    fmt::format("{} {} has the id {} of {} {} in line {}; it gets none", word, in_quotes(device.name),
                                device.id, word, in_quotes(first->second->name), first->second->line));
    device.id = -1;
  }
}

}  // namespace

void report_ignored(const XMLElement& element, const std::vector<std::string_view>& known, Findings& findings) {
  for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    bool is_known = false;
    for (const std::string_view name : known) is_known = is_known || name == child->Name();
    if (!is_known) findings.ignored(child->GetLineNum(), fmt::format("<{}>{}", element.Name(), tag(child->Name())));
  }
}

double read_positive_or(const XMLElement* element, const char* child, double fallback, double most,
                        Findings& findings) {
  const XMLElement* place = element == nullptr ? nullptr : element->FirstChildElement(child);
  if (place == nullptr) return fallback;
  const auto value = read_text_number(*place, findings);
  if (!value) return fallback;
  if (*value > 0.0 && *value <= most) return *value;
  findings.error(place->GetLineNum(),
                 std::isfinite(most) ? fmt::format("<{}> is {}; it must be above 0 and at most {}", child, *value, most)
                                     : fmt::format("<{}> is {}; it must be above 0", child, *value));
  return fallback;
}

int read_count_or(const XMLElement* element, const char* child, int fallback, int most, Findings& findings) {
  const double value = read_positive_or(element, child, fallback, most, findings);
  if (value != std::floor(value)) {
    findings.error(element->FirstChildElement(child)->GetLineNum(),
                   fmt::format("<{}> is {}, not a whole number", child, value));
    return fallback;
  }
  return static_cast<int>(value);
}

std::optional<double> read_positive(const XMLElement& element, const char* attribute, double most, Findings& findings) {
  const auto value = read_number(element, attribute, findings);
  if (!value || (*value > 0.0 && *value <= most)) return value;
  const std::string limit = std::isfinite(most) ? fmt::format(" and at most {}", most) : "";
  findings.error(element.GetLineNum(),
                 fmt::format("{} of <{}> is {}; it must be above 0{}", attribute, element.Name(), *value, limit));
  return std::nullopt;
}

std::optional<int> read_count(const XMLElement& element, const char* attribute, int most, Findings& findings) {
  const auto value = read_positive(element, attribute, most, findings);
  if (!value) return std::nullopt;
  if (*value == std::floor(*value)) return static_cast<int>(*value);
  findings.error(element.GetLineNum(),
                 fmt::format("{} of <{}> is {}, not a whole number", attribute, element.Name(), *value));
  return std::nullopt;
}

std::string_view word_for(const Device& device) {
  if (std::holds_alternative<Rotor>(device.kind)) return "rotor";
  if (std::holds_alternative<Holder>(device.kind)) return "holder";
  return std::holds_alternative<Light>(device.kind) ? "light" : "sensor";
}

Eigen::Matrix3d device_axes() {
  return (Eigen::Matrix3d() << 0, 0, -1,  //
          -1, 0, 0,                       //
          0, 1, 0)
      .finished();
}

Eigen::Matrix3d device_axes_of_optical() { return Eigen::Vector3d(1, -1, -1).asDiagonal(); }

std::vector<DeviceDraft> read_devices(const XMLElement& robot, Findings& findings) {
  std::vector<DeviceDraft> devices;
  std::vector<Unread> unread;
  for (const auto* part = robot.FirstChildElement(); part != nullptr; part = part->NextSiblingElement()) {
    const std::string_view kind = part->Name();
    if (kind == "sensor") read_device(*part, devices, unread, findings);
    if (kind != "gazebo") continue;
    for (const auto* child = part->FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      const std::string_view what = child->Name();
      if (is_one_of(what, {"sensor", "light", "rotor", "holder"})) read_device(*child, devices, unread, findings);
      if (!what.starts_with("sensor:")) continue;
      findings.warning(child->GetLineNum(),
                       fmt::format("{} is the form of a sensor in Gazebo before 2012; it is passed over", tag(what)),
                       "write <sensor name=\"...\" type=\"...\">");
    }
  }
  report_unread(unread, devices, findings);
  settle_names(devices, findings);
  settle_ids(devices, findings);
  return devices;
}

}  // namespace rehearse::urdf
