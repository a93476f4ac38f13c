#include "initial_commands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text.h"

namespace rehearse {
namespace {

constexpr std::pair<const char*, double JointCommand::*> of_joints[] = {
    {"q", &JointCommand::q}, {"dq", &JointCommand::dq}, {"u", &JointCommand::u}};

std::string metadata_key(const ScenarioBody& body, const std::string& owner, const char* quantity) {
  return fmt::format("{}/{} {}", body.name, owner, quantity);
}

std::string command_text(const Eigen::Vector3d& a, std::span<const double> b) {
  return fmt::format("{} {} {} {}", a.x(), a.y(), a.z(), fmt::join(b, " "));
}

/// The finite numbers of a text.
std::vector<double> command_numbers(const std::string* text) {
  std::vector<double> numbers;
  std::istringstream words(text == nullptr ? std::string() : *text);
  for (std::string word; words >> word;)
    if (const auto number = number_in<double>(word); number && std::isfinite(*number)) numbers.push_back(*number);
  return numbers;
}

/// The finite numbers of a text, if it has that many.
std::vector<double> command_numbers(const std::string* text, std::size_t count) {
  std::vector<double> numbers = command_numbers(text);
  return numbers.size() == count ? numbers : std::vector<double>();
}

/// A number that the metadata leave out.
double number_at_rest(const ScenarioBody& body, std::string_view owner, std::string_view quantity) {
  if (quantity == "pose") return std::numeric_limits<double>::quiet_NaN();
  if (quantity != "q") return 0.0;
  for (const double& posture : body.joints)
    if (const auto id = static_cast<std::size_t>(&posture - body.joints.data());
        body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint.name == owner)
      return posture;
  return 0.0;
}

Eigen::Vector3d vector_of(const std::vector<double>& numbers, std::size_t at) {
  return {numbers[at], numbers[at + 1], numbers[at + 2]};
}

}  // namespace

mcap::StringMap metadata_of_initial_commands(const Scenario& scenario, const Command& command) {
  mcap::StringMap metadata;
  for (std::size_t b = 0; b < scenario.bodies.size(); ++b) {
    const ScenarioBody& body = scenario.bodies[b];
    const BodyCommand& of_body = command.bodies[b];
    const std::vector<Link>& links = body.model->links;
    for (std::size_t id = 0; id < of_body.joints.size(); ++id) {
      const JointCommand at_rest{drive_none, body.joints[id], 0.0, 0.0};
      const std::string& joint = links[static_cast<std::size_t>(body.model->joints[id])].joint.name;
      for (const auto& [quantity, number] : of_joints)
        if (of_body.joints[id].*number != at_rest.*number)
          metadata[metadata_key(body, joint, quantity)] = fmt::format("{}", of_body.joints[id].*number);
    }
    for (const auto& [link, motion] : of_body.given) {
      const std::string& name = links[static_cast<std::size_t>(link)].name;
      if (motion.place)
        metadata[metadata_key(body, name, "pose")] =
            command_text(motion.place->position, {motion.place->rotation.coeffs().data(), 4});
      if (motion.twist)
        metadata[metadata_key(body, name, "twist")] =
            command_text(motion.twist->velocity, {motion.twist->angular_velocity.data(), 3});
    }
  }
  return metadata;
}

void take_initial_commands(const mcap::StringMap& metadata, const Scenario& scenario, Command& command) {
  const auto stated = [&](const ScenarioBody& body, const std::string& owner, const char* quantity) {
    const auto found = metadata.find(metadata_key(body, owner, quantity));
    return found == metadata.end() ? nullptr : &found->second;
  };
  for (std::size_t b = 0; b < scenario.bodies.size(); ++b) {
    const ScenarioBody& body = scenario.bodies[b];
    BodyCommand& of_body = command.bodies[b];
    const std::vector<Link>& links = body.model->links;
    for (std::size_t id = 0; id < of_body.joints.size(); ++id)
      for (const auto& [quantity, number] : of_joints) {
        const std::string& joint = links[static_cast<std::size_t>(body.model->joints[id])].joint.name;
        if (const auto numbers = command_numbers(stated(body, joint, quantity), 1); !numbers.empty())
          of_body.joints[id].*number = numbers[0];
      }
    for (std::size_t i = 0; i < links.size(); ++i) {
      const std::string& name = links[i].name;
      if (const auto numbers = command_numbers(stated(body, name, "pose"), 7); !numbers.empty())
        of_body.given[static_cast<int>(i)].place =
            LinkPlace{vector_of(numbers, 0), {numbers[6], numbers[3], numbers[4], numbers[5]}};
      if (const auto numbers = command_numbers(stated(body, name, "twist"), 6); !numbers.empty())
        of_body.given[static_cast<int>(i)].twist = LinkTwist{vector_of(numbers, 0), vector_of(numbers, 3)};
    }
  }
}

std::vector<InitialNumber> initial_numbers(const mcap::StringMap& recorded, const mcap::StringMap& now,
                                           const Scenario& scenario) {
  std::set<std::string> keys;
  for (const mcap::StringMap* stated : {&recorded, &now})
    for (const auto& [key, numbers] : *stated) keys.insert(key);
  const auto text_in = [](const mcap::StringMap& stated, const std::string& key) {
    const auto found = stated.find(key);
    return found == stated.end() ? nullptr : &found->second;
  };
  std::vector<InitialNumber> all;
  for (const std::string& key : keys) {
    const std::size_t slash = key.find('/'), space = key.rfind(' ');
    if (slash == std::string::npos || space == std::string::npos || space < slash) continue;
    const auto body = std::ranges::find(scenario.bodies, key.substr(0, slash), &ScenarioBody::name);
    if (body == scenario.bodies.end()) continue;
    const std::string owner = key.substr(slash + 1, space - slash - 1), quantity = key.substr(space + 1);
    std::vector<double> before = command_numbers(text_in(recorded, key)), after = command_numbers(text_in(now, key));
    const std::size_t count = std::max(before.size(), after.size());
    for (std::vector<double>* numbers : {&before, &after})
      numbers->resize(count, number_at_rest(*body, owner, quantity));
    for (std::size_t i = 0; i < count; ++i)
      all.push_back({body->name, fmt::format("{}/{}{}", owner, quantity, count > 1 ? fmt::format("/{}", i) : ""),
                     before[i], after[i]});
  }
  return all;
}

}  // namespace rehearse
