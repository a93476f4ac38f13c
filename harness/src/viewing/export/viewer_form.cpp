#include "viewer_form.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "viewer_messages.h"

namespace rehearse {
namespace {

/// The length of an arrow per force [m/N].
constexpr double arrow_scale = 0.002;

std::string attachment_text(const mcap::Reader& log, const std::string& name) {
  for (const mcap::Attachment& attachment : log.attachments())
    if (attachment.name == name) return std::string(attachment.text());
  return "";
}

void prefix(tinyxml2::XMLElement* element, const char* attribute, const std::string& body) {
  if (element == nullptr) return;
  if (const char* name = element->Attribute(attribute)) element->SetAttribute(attribute, (body + "/" + name).c_str());
}

/// The URDF with links named as frames; nullopt: the text isn't a URDF.
std::optional<std::string> with_frames(const std::string& urdf, const std::string& body) {
  tinyxml2::XMLDocument document;
  if (document.Parse(urdf.data(), urdf.size()) != tinyxml2::XML_SUCCESS) return std::nullopt;
  tinyxml2::XMLElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) return std::nullopt;
  for (auto* link = robot->FirstChildElement("link"); link; link = link->NextSiblingElement("link"))
    prefix(link, "name", body);
  for (auto* joint = robot->FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    prefix(joint->FirstChildElement("parent"), "link", body);
    prefix(joint->FirstChildElement("child"), "link", body);
  }
  for (auto* part = robot->FirstChildElement("gazebo"); part; part = part->NextSiblingElement("gazebo"))
    prefix(part, "reference", body);
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

/// The URDF element of a geometry; empty if URDF has no such geometry.
std::string urdf_of(const Geometry& geometry) {
  if (const auto* box = std::get_if<Box>(&geometry))
    return fmt::format("<box size=\"{} {} {}\"/>", box->size.x(), box->size.y(), box->size.z());
  if (const auto* sphere = std::get_if<Sphere>(&geometry))
    return fmt::format("<sphere radius=\"{}\"/>", sphere->radius);
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    return fmt::format("<cylinder radius=\"{}\" length=\"{}\"/>", cylinder->radius, cylinder->length);
  return "";
}

/// The URDF of an inline shape of a scenario; nullopt if URDF has no such geometry.
std::optional<std::string> urdf_of_shape(const ScenarioBody& body) {
  std::string visuals;
  for (const Shape& shape : body.model->links[0].visuals) {
    const std::string geometry = urdf_of(shape.geometry);
    if (geometry.empty()) return std::nullopt;
    const Eigen::Vector3d p = shape.pose.translation();
    const Eigen::Vector3d ypr = shape.pose.linear().eulerAngles(2, 1, 0);
    const Color color = shape.color.value_or(Color(0.7F, 0.7F, 0.7F, 1.0F));
    visuals += fmt::format(
        "<visual><origin xyz=\"{} {} {}\" rpy=\"{} {} {}\"/><geometry>{}</geometry><material name=\"{}\"><color "
        "rgba=\"{} {} {} {}\"/></material></visual>",
        p.x(), p.y(), p.z(), ypr[2], ypr[1], ypr[0], geometry, body.name, color[0], color[1], color[2], color[3]);
  }
  return fmt::format("<robot name=\"{0}\"><link name=\"{0}/{1}\">{2}</link></robot>\n", body.name,
                     body.model->links[0].name, visuals);
}

Eigen::Isometry3d pose_of(const msg::Transform& transform) {
  const msg::Vector3& place = transform.translation;
  const msg::Quaternion& rotation = transform.rotation;
  return Eigen::Translation3d(place.x, place.y, place.z) *
         Eigen::Quaterniond(rotation.w, rotation.x, rotation.y, rotation.z);
}

msg::Transform transform_of(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(pose.linear()).normalized();
  const Eigen::Vector3d place = pose.translation();
  return {{place.x(), place.y(), place.z()}, {rotation.x(), rotation.y(), rotation.z(), rotation.w()}};
}

/// The transform from a link to one of its devices. A camera of the model looks along its -z, with y up; in ROS it
/// looks along z, with y down.
msg::TransformStamped frame_of(const ScenarioBody& body, const Device& device, std::uint64_t time) {
  Eigen::Isometry3d pose = device.pose;
  if (std::holds_alternative<Camera>(device.kind))
    pose.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  msg::TransformStamped frame;
  frame.header.stamp = msg::Time::from_ns(time);
  frame.header.frame_id = body.name + "/" + body.model->links[device.link].name;
  frame.child_frame_id = body.name + "/" + device.name;
  frame.transform = transform_of(pose);
  return frame;
}

/// Makes the poses of links relative to their parents, if a message has both in the world.
void make_relative(msg::TFMessage& frames, const std::map<std::string, std::string>& parents) {
  std::map<std::string, Eigen::Isometry3d> in_world;
  for (const msg::TransformStamped& frame : frames.transforms)
    if (frame.header.frame_id == "world") in_world[frame.child_frame_id] = pose_of(frame.transform);
  for (msg::TransformStamped& frame : frames.transforms) {
    const auto parent = parents.find(frame.child_frame_id);
    if (parent == parents.end() || !in_world.contains(parent->second) || !in_world.contains(frame.child_frame_id))
      continue;
    frame.header.frame_id = parent->second;
    frame.transform = transform_of(in_world[parent->second].inverse() * in_world[frame.child_frame_id]);
  }
}

void add_arrow(const msg::Header& header, const msg::Point& from, const msg::Vector3& force, msg::MarkerArray& array) {
  if (force.x == 0.0 && force.y == 0.0 && force.z == 0.0) return;
  msg::Marker& arrow = array.markers.emplace_back();
  arrow.header = header;
  arrow.ns = "contacts";
  arrow.id = static_cast<std::int32_t>(array.markers.size());
  arrow.scale = {0.01, 0.02, 0.0};  // [m]: diameters of shaft and head
  arrow.color = {1.0F, 0.3F, 0.1F, 1.0F};
  arrow.points = {from,
                  {from.x + force.x * arrow_scale, from.y + force.y * arrow_scale, from.z + force.z * arrow_scale}};
}

}  // namespace

ViewerForm::ViewerForm(const mcap::Reader& log, const Scenario& scenario, Sink& sink, bool contacts)
    : log_(log), scenario_(scenario), sink_(sink), contacts_(contacts) {
  for (const auto& [id, channel] : log.channels()) {
    const mcap::Schema* schema = log.schema_of(channel);
    types_[id] = schema ? schema->name : "";
  }
  for (const ScenarioBody& body : scenario.bodies)
    for (const Link& link : body.model->links)
      if (link.parent >= 0)
        parents_[body.name + "/" + link.name] = body.name + "/" + body.model->links[link.parent].name;
}

template <class T>
std::uint32_t ViewerForm::add_topic(const std::string& topic) {
  return sink_.add_topic(topic, T::type_name, msg::schema_text<T>());
}

template <class T>
Result<void> ViewerForm::put(std::uint32_t topic, std::uint64_t time, const T& message) {
  CdrWriter cdr;
  msg::encode(message, cdr);
  return sink_.put(topic, time, cdr.bytes());
}

Result<void> ViewerForm::put_first(std::uint64_t start) {
  REHEARSE_TRY(describe_bodies(start));
  return put_frames(start);
}

Result<void> ViewerForm::describe_bodies(std::uint64_t start) {
  bool any = false;
  for (const ScenarioBody& body : scenario_.bodies) {
    const auto urdf =
        body.model_file.empty() ? urdf_of_shape(body) : with_frames(attachment_text(log_, body.model_file), body.name);
    if (!urdf) {
      remarks_.push_back(
          warning(fmt::format("{} has no description: it is no URDF, and no box, sphere or cylinder", body.name)));
      continue;
    }
    const msg::String description{*urdf};
    REHEARSE_TRY(put(add_topic<msg::String>("/" + body.name + "/robot_description"), start, description));
    if (any || body.controllers.empty()) continue;
    any = true;
    REHEARSE_TRY(put(add_topic<msg::String>("/robot_description"), start, description));
  }
  return {};
}

Result<void> ViewerForm::put_frames(std::uint64_t start) {
  msg::TFMessage frames;
  for (const ScenarioBody& body : scenario_.bodies)
    for (const Device& device : body.model->devices) {
      frames.transforms.push_back(frame_of(body, device, start));
      frames_.push_back(frames.transforms.back().child_frame_id);
    }
  return frames.transforms.empty() ? Result<void>() : put(add_topic<msg::TFMessage>("/tf_static"), start, frames);
}

void ViewerForm::add_topics() {
  const auto has_type = [&](std::string_view type) {
    return std::ranges::any_of(types_, [&](const auto& one) { return one.second == type; });
  };
  if (has_type(msg::Event::type_name)) rosout_ = add_topic<msg::Log>("/rosout");
  for (const auto& [id, channel] : log_.channels())
    if (contacts_ && (types_[id] == msg::Contacts::type_name || types_[id] == msg::ContactForce::type_name))
      markers_[id] = add_topic<msg::MarkerArray>(channel.topic + "/markers");
}

std::optional<std::uint32_t> ViewerForm::derived_from(std::uint16_t channel) const {
  const auto type = types_.find(channel);
  if (rosout_ && type != types_.end() && type->second == msg::Event::type_name) return rosout_;
  const auto markers = markers_.find(channel);
  return markers == markers_.end() ? std::nullopt : std::optional(markers->second);
}

Result<void> ViewerForm::derive(const mcap::Message& message) {
  const std::string& type = type_of(*message.channel);
  CdrReader cdr(message.data);
  if (type == msg::Event::type_name) {
    msg::Event event;
    if (!msg::decode(cdr, event)) return {};
    msg::Log log;
    log.stamp = event.stamp;
    log.level = event.severity == "error"     ? msg::Log::error
                : event.severity == "warning" ? msg::Log::warn
                                              : msg::Log::info;
    log.name = event.source;
    log.msg = event.text;
    return put(*rosout_, message.log_time, log);
  }
  const auto markers = markers_.find(message.channel->id);
  if (markers == markers_.end()) return {};
  msg::MarkerArray array;
  if (type == msg::Contacts::type_name) {
    msg::Contacts contacts;
    if (!msg::decode(cdr, contacts)) return {};
    for (const msg::Contact& contact : contacts.contacts)
      add_arrow(contacts.header, contact.position, contact.force, array);
  } else {
    msg::ContactForce sum;
    if (!msg::decode(cdr, sum)) return {};
    add_arrow(sum.header, {}, sum.force, array);
  }
  msg::Marker& clear = *array.markers.emplace(array.markers.begin());
  clear.header.frame_id = "world";
  clear.ns = "contacts";
  clear.action = msg::Marker::delete_all;
  return put(markers->second, message.log_time, array);
}

/// Viewers take a link's parent from its description, and discard poses with a different parent.
mcap::Bytes ViewerForm::data_of(const mcap::Message& message) {
  if (type_of(*message.channel) != msg::TFMessage::type_name) return message.data;
  CdrReader cdr(message.data);
  msg::TFMessage frames;
  if (!msg::decode(cdr, frames)) return message.data;
  make_relative(frames, parents_);
  relative_.reset();
  msg::encode(frames, relative_);
  return relative_.bytes();
}

}  // namespace rehearse
