#include "branch_origin.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "base/clock.h"
#include "base/hashing.h"
#include "base/names.h"
#include "base/text.h"
#include "tick_span.h"

namespace rehearse {

Result<std::string> name_and_hash(const std::filesystem::path& file) {
  const auto hash = REHEARSE_TRY(hash_of_file(file));
  return fmt::format("{} {}", file.filename().string(), hash_text(hash));
}

namespace {

/// Parses "0,0,50".
bool parse_vector(std::string_view text, Eigen::Vector3d& vector) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t comma = axis < 2 ? text.find(',') : text.size();
    const auto number = comma == std::string_view::npos ? std::nullopt : number_in<double>(text.substr(0, comma));
    if (!number) return false;
    vector[axis] = *number;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return vector.allFinite();
}

/// Finds body and link of "Box/Box"; returns a message if there is none.
std::string find_link(const std::string& name, const Scenario& scenario, Push& push) {
  std::vector<std::string> known;
  for (std::size_t body = 0; body < scenario.bodies.size(); ++body) {
    const std::vector<Link>& links = scenario.bodies[body].model->links;
    for (std::size_t link = 0; link < links.size(); ++link) {
      known.push_back(scenario.bodies[body].name + "/" + links[link].name);
      push.body = static_cast<int>(body);
      push.link = static_cast<int>(link);
      if (known.back() == name) return {};
    }
  }
  return fmt::format("there is no link '{}'; {}", name, name_hint(name, known, "links"));
}

}  // namespace

Result<Push> parse_push(const std::string& text, const Scenario& scenario) {
  Push push;
  const std::size_t end_of_name =
      std::min({text.find(" force="), text.find(" torque="), text.find(" at="), text.size()});
  const auto wrong = [&](std::size_t begin, std::size_t size, const std::string& message) {
    return error_at({text, begin, size}, message);
  };
  if (const std::string problem = find_link(text.substr(0, end_of_name), scenario, push); !problem.empty())
    return wrong(0, end_of_name, problem);
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos || at < end_of_name)
    return wrong(text.size(), 1, "a push lasts for a span: expected @3.2s..3.3s or @tick:640..660 at its end");
  bool has_effect = false;
  for (std::size_t begin = end_of_name; begin < at;) {
    begin = text.find_first_not_of(' ', begin);
    if (begin >= at) break;
    const std::size_t end = std::min(text.find(' ', begin), at);
    const std::string_view word = std::string_view(text).substr(begin, end - begin);
    const std::array<std::pair<std::string_view, Eigen::Vector3d*>, 3> known{
        {{"force=", &push.force}, {"torque=", &push.torque}, {"at=", &push.point}}};
    const auto key = std::ranges::find_if(known, [&](const auto& one) { return word.starts_with(one.first); });
    if (key == known.end() || !parse_vector(word.substr(key->first.size()), *key->second))
      return wrong(begin, word.size(),
                   fmt::format("'{}' is none of force=X,Y,Z [N], torque=X,Y,Z [N·m], at=X,Y,Z [m]", word));
    has_effect = has_effect || key->second != &push.point;
    begin = end;
  }
  if (!has_effect) return wrong(0, text.size(), "the push has neither force nor torque");
  const auto span = REHEARSE_TRY(parse_span(text, at + 1, scenario.time_step));
  push.from = time_of(span.first, scenario.time_step);
  push.until = time_of(span.last + 1, scenario.time_step);
  return push;
}

}  // namespace rehearse
