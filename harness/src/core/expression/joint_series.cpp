#include "joint_series.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/names.h"
#include "name_search.h"

namespace rehearse {
namespace {

std::vector<std::string_view> parts_of(std::string_view name) {
  std::vector<std::string_view> segments;
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    segments.push_back(name.substr(at, end - at));
    at = end + 1;
  }
  return segments;
}

/// BODY/JOINT of the series of a joint, or of a command to it; empty: the series is of another kind.
std::string joint_of(std::string_view name, std::string_view quantity, bool of_command) {
  const std::vector<std::string_view> parts = parts_of(name);
  const std::size_t wanted = of_command ? 5 : 3;
  if (parts.size() != wanted || parts.back() != quantity || (of_command && parts[2] != "output")) return {};
  return fmt::format("{}/{}", parts[0], parts[wanted - 2]);
}

}  // namespace

Result<std::size_t> find_joint_name(std::string_view joint, std::string_view quantity, bool of_command,
                                    const std::vector<std::string>& names) {
  std::vector<std::size_t> found;
  std::vector<std::string> candidates, joints;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string owner = joint_of(names[i], quantity, of_command);
    if (owner.empty()) continue;
    joints.push_back(owner);
    if (!ends_with_segments(owner, joint)) continue;
    found.push_back(i);
    candidates.push_back(names[i]);
  }
  if (found.size() == 1) return found.front();
  const std::string what = fmt::format("{} '{}'", of_command ? "command to a joint" : "joint", joint);
  if (found.empty())
    return error(fmt::format("there is no {} with {}", what, quantity), name_hint(joint, joints, "joints"));
  return error(fmt::format("{} may be one of {} series", what, found.size()), listed(candidates, 6));
}

std::vector<std::string> spellings_of(std::string_view series) {
  std::vector<std::string> names{std::string(series)};
  const std::size_t slash = series.rfind('/');
  if (slash == std::string_view::npos) return names;
  const std::string_view last = series.substr(slash + 1);
  const std::string link(series.substr(0, slash));
  if (last == "x" || last == "y" || last == "z") names.push_back(fmt::format("{}/position/{}", link, last));
  if (last == "roll" || last == "pitch" || last == "yaw")
    for (const char* part : {"x", "y", "z", "w"}) names.push_back(fmt::format("{}/orientation/{}", link, part));
  return names;
}

}  // namespace rehearse
