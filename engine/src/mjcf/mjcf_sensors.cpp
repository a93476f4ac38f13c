// <sensor>: devices at the places of sites.
#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <set>

#include "base/names.h"
#include "mjcf_bodies.h"
#include "urdf/urdf_values.h"

namespace rehearse::mjcf {
namespace {

class SensorReader {
 public:
  SensorReader(Files& files, Draft& draft) : files_(files), draft_(draft) {
    for (const urdf::DeviceDraft& device : draft.tree.devices) names_.insert(device.device.name);
  }
  void read(const XMLElement& xml);

 private:
  const SitePlace* site_of(const Element& element);
  void add(const Element& element, const SitePlace& site, DeviceKind kind);

  Files& files_;
  Draft& draft_;
  std::set<std::string> names_;
  std::map<std::string, std::set<std::string>> wrenches_;  // by site: force, torque
};

const SitePlace* SensorReader::site_of(const Element& element) {
  const std::string name = element.text_or("site", "");
  const auto found = draft_.sites.find(name);
  if (found == draft_.sites.end() || name.empty()) {
    std::vector<std::string> names;
    for (const auto& [each, site] : draft_.sites) names.push_back(printable(each));
    element.error(fmt::format("a {} sensor is at the site {}, which the model lacks", element.kind(), in_quotes(name)),
                  names.empty() ? "<site name=\"...\"/> in a body" : name_hint(name, names, "sites"));
    return nullptr;
  }
  if (!found->second.link.empty()) return &found->second;
  files_.ignored(element.xml(), fmt::format("a {} sensor in <worldbody>", element.kind()));
  return nullptr;
}

void SensorReader::add(const Element& element, const SitePlace& site, DeviceKind kind) {
  const std::string wanted =
      element.text_or("name", fmt::format("{}_{}", element.text_or("site", ""), element.kind()).c_str());
  std::string name = wanted;
  for (int i = 2; !names_.insert(name).second; ++i) name = fmt::format("{}_{}", wanted, i);
  urdf::DeviceDraft& draft = draft_.tree.devices.emplace_back();
  draft.device.name = name;
  draft.device.kind = std::move(kind);
  draft.device.line = files_.line_in_main(element.xml());
  draft.device.pose = site.pose;
  draft.reference = site.link;
  draft.meaning = urdf::Reference::link;
}

void SensorReader::read(const XMLElement& xml) {
  const Element element(files_, xml, nullptr);
  const std::string_view kind = element.kind();
  if (!urdf::is_one_of(kind, {"gyro", "accelerometer", "magnetometer", "force", "torque", "touch", "rangefinder"}))
    return files_.ignored(xml, fmt::format("a {} sensor", printable(kind)));
  if (kind == "rangefinder" && !element.states("site"))
    return element.unsupported("a rangefinder of a camera", "site=\"NAME\"");
  const SitePlace* site = site_of(element);
  if (site == nullptr) return;
  if (kind == "gyro") return add(element, *site, Gyro());
  if (kind == "accelerometer") return add(element, *site, Accelerometer());
  if (kind == "magnetometer") return add(element, *site, Magnetometer());
  if (kind == "touch") return add(element, *site, ContactSensor());
  if (kind == "rangefinder") {
    RangeSensor range;
    range.min_distance = 0.0;
    if (const double cutoff = element.number("cutoff").value_or(0.0); cutoff > 0.0) range.max_distance = cutoff;
    SitePlace turned = *site;  // a site's beam is along z, a range sensor's against it
    turned.pose.linear() = turned.pose.linear() * Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    return add(element, turned, range);
  }
  // one sensor measures force and torque
  std::set<std::string>& measured = wrenches_[element.text_or("site", "")];
  const bool is_new = measured.insert(std::string(kind)).second;
  if (measured.size() == 1 || !is_new) return add(element, *site, ForceSensor());
}

}  // namespace

void read_sensors(Files& files, Draft& draft) {
  SensorReader reader(files, draft);
  for (const XMLElement* xml : files.in_section("sensor")) reader.read(*xml);
}

}  // namespace rehearse::mjcf
