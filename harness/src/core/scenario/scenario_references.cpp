// The parts that refer to bodies read before: pushes, cameras, and tolerances.
#include "base/names.h"
#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse {
namespace {

const BoundForm<Push>& bound_push_form() {
  static const BoundForm<Push> form{
      "push",
      "a push",
      {FormKey{"body", types::text(), "the body that is pushed", required},
       FormKey{"link", types::text(), "its link; default: the root"},
       {"force", &Push::force, any_force, "in the world frame [N]"},
       {"torque", &Push::torque, any_torque, "in the world frame [N·m]"},
       {"at", &Push::point, any_position, "point of attack of the force, in the link's frame; only with force [m]"},
       FormKey{"from", types::number(any_time), "when it begins [s]", required},
       FormKey{"until", types::number(any_time), "when it ends [s]", required}},
      {{"force", "torque"}}};
  return form;
}

const BoundForm<ToleranceRule>& bound_tolerance_form() {
  constexpr Range a_second{0.0, 1.0, "[s]"};  // a longer delay isn't a delay but a different motion
  static const BoundForm<ToleranceRule> form{
      "tolerance",
      "a tolerance",
      {FormKey{"channel", types::text_like("^[^/]"),
               "a pattern of channel names, such as SR1/*/q; * matches any text, slashes included; no slash at its "
               "beginning",
               required},
       {"atol", &ToleranceRule::atol, {0.0, 1e9}, "allowed difference, in the channel's unit"},
       {"rtol",
        &ToleranceRule::rtol,
        {0.0, 1.0},
        "allowed difference as a share of the channel's largest magnitude in the golden"},
       {"lead", &ToleranceRule::lead, a_second,
        "how much earlier than in the golden a value may come, see below; default: 0 [s]"},
       {"lag", &ToleranceRule::lag, a_second,
        "how much later than in the golden a value may come, see below; default: 0 [s]"},
       {"ticks",
        &ToleranceRule::ticks,
        {0, 1000},
        "allowed distance of an event: contacts/LINK/OTHER, limits/BODY/JOINT/u, controller_results/0, events/SOURCE; "
        "default: 1 for contacts and limits, else 0"},
       {"pixel_share", &ToleranceRule::pixel_share, {0.0, 1.0}, "share of a picture's pixels that may differ"},
       {"pixel_delta",
        &ToleranceRule::pixel_delta,
        {0.0, 255.0},
        "difference of a color that still counts as equal [of 255]"},
       {"pixel_window",
        &ToleranceRule::pixel_window,
        {0.0, 1.0},
        "share of the pixels of any square of 16 x 16 that may differ: those of a missing object are dense, speckle "
        "isn't; default: 0.25"}},
      {{"atol", "rtol", "lead", "lag", "ticks", "pixel_share", "pixel_delta", "pixel_window"}}};
  return form;
}

std::vector<std::string> camera_names(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const ScenarioBody& body : scenario.bodies) {
    if (body.model == nullptr) continue;
    for (const Device& device : body.model->devices)
      if (std::holds_alternative<Camera>(device.kind)) names.push_back(body.name + "/" + device.name);
  }
  return names;
}

void read_target(Findings& findings, const Keys& keys, const Scenario& scenario, Push& push) {
  const YamlNode* body_node = keys.require("body", "the name of a body");
  if (body_node == nullptr) return;
  const auto name = read_text(findings, *body_node, "body", "the name of a body");
  const auto body = name ? find_body(findings, *body_node, *name, scenario) : std::nullopt;
  if (!body) return;
  push.body = *body;
  const ScenarioBody& target = scenario.bodies[static_cast<std::size_t>(*body)];
  const YamlNode* link = keys.find("link");
  const auto link_name = link == nullptr ? std::nullopt : read_text(findings, *link, "link", "the name of a link");
  if (link_name && target.model != nullptr) push.link = find_link(findings, *link, *link_name, target).value_or(0);
  if (target.fixed && push.link == 0)
    findings.warning(*body_node, fmt::format("the push does nothing: the root link of {} is fixed", target.name),
                     "name another link");
}

void read_push(Findings& findings, const YamlNode& node, Scenario& scenario) {
  const Keys keys(findings, node, push_form());
  if (!keys.is_map()) return;
  Push push;
  read_target(findings, keys, scenario, push);
  if (keys.find("force") == nullptr && keys.find("torque") == nullptr)
    findings.error(node, "a push has neither 'force' nor 'torque'", "expected force: [x, y, z] in the world frame [N]");
  bound_push_form().read(keys, push);
  if (const YamlNode* at = keys.find("at"); at != nullptr && keys.find("force") == nullptr)
    findings.error(*at, "'at' without 'force'",
                   "it is the point where the force acts; a torque acts on the link as a whole");
  if (const auto span = read_span(findings, keys, scenario, "push")) {
    push.from = span->from;
    push.until = span->until;
  }
  scenario.pushes.push_back(push);
}

void read_camera(Findings& findings, const YamlNode& node, const Scenario& scenario,
                 std::vector<std::string>& cameras) {
  const auto name = read_text(findings, node, "a camera", "Body/Camera");
  if (!name) return;
  if (std::ranges::find(cameras, *name) != cameras.end())
    findings.error(node, fmt::format("the camera '{}' is listed twice", *name), "list it once");
  const std::string body_name = name->substr(0, name->find('/'));
  if (body_name.size() == name->size()) {
    expected(findings, node, "a camera", "Body/Camera");
    return;
  }
  const auto body = find_body(findings, node, body_name, scenario);
  if (!body || scenario.bodies[static_cast<std::size_t>(*body)].model == nullptr) return;
  const std::vector<std::string> known = camera_names(scenario);
  if (std::ranges::find(known, *name) == known.end())
    findings.error(node, fmt::format("there is no camera '{}'", shortened(*name)), name_hint(*name, known, "cameras"));
  cameras.push_back(*name);
}

void read_tolerance(Findings& findings, const YamlNode& node, Scenario& scenario) {
  const Keys keys(findings, node, tolerance_form());
  if (!keys.is_map()) return;
  ToleranceRule rule;
  rule.place = {scenario.file, node.line, node.column};
  if (const YamlNode* channel = keys.require("channel", "a pattern of channels, such as SR1/*/q")) {
    rule.channel = read_text(findings, *channel, "channel", "a pattern of channels").value_or("");
    rule.place = {scenario.file, channel->line, channel->column};
    if (channel->kind == YamlNode::Kind::scalar && (rule.channel.empty() || rule.channel.front() == '/'))
      expected(findings, *channel, "channel", "a pattern such as SR1/*/q, without a slash at its beginning");
  }
  bound_tolerance_form().read(keys, rule);
  if (keys.entries().size() == (keys.find("channel") == nullptr ? 0u : 1u))
    findings.error(node, "a tolerance allows nothing",
                   "expected one of atol, rtol, lead, lag, ticks, pixel_share, pixel_delta, pixel_window");
  scenario.tolerances.push_back(std::move(rule));
}

/// Rate of a device's measurements [Hz]; 0 for devices that measure in every step, and for cameras that don't run.
double rate_of(const Device& device, const ScenarioBody& body, const Scenario& scenario) {
  if (const auto* laser = std::get_if<RangeSensor>(&device.kind)) return laser->scan_rate;
  const auto* camera = std::get_if<Camera>(&device.kind);
  return camera != nullptr && scenario.runs_camera(body.name, device.name) ? camera->frame_rate : 0.0;
}

}  // namespace

const Form& push_form() { return bound_push_form(); }
const Form& tolerance_form() { return bound_tolerance_form(); }

std::optional<int> find_body(Findings& findings, const YamlNode& at, std::string_view name, const Scenario& scenario) {
  std::vector<std::string> names;
  for (const ScenarioBody& body : scenario.bodies) {
    if (body.name == name) return static_cast<int>(names.size());
    names.push_back(body.name);
  }
  findings.error(at, fmt::format("there is no body '{}'", shortened(name)), name_hint(name, names, "bodies"));
  return std::nullopt;
}

std::optional<int> find_link(Findings& findings, const YamlNode& at, const std::string& name,
                             const ScenarioBody& body) {
  const int link = body.model->find_link(name);
  if (link >= 0) return link;
  std::vector<std::string> names;
  for (const Link& known : body.model->links) names.push_back(known.name);
  findings.error(at, fmt::format("{} has no link '{}'", body.name, shortened(name)), name_hint(name, names, "links"));
  return std::nullopt;
}

std::optional<Span> read_span(Findings& findings, const Keys& keys, const Scenario& scenario, std::string_view what) {
  const Range times{0.0, Scenario::max_duration, "[s]"};
  const YamlNode* from_node = keys.require("from", "when it begins [s]");
  const YamlNode* until_node = keys.require("until", "when it ends [s]");
  std::optional<double> from, until;
  if (from_node != nullptr) from = read_number(findings, *from_node, "from", times);
  if (until_node != nullptr) until = read_number(findings, *until_node, "until", times);
  if (!from || !until) return std::nullopt;
  if (*until <= *from) {
    findings.error(*until_node, fmt::format("until is {}, which is not after from", *until),
                   fmt::format("expected a time above {} [s]", *from));
  } else if (scenario.duration > 0.0 && *from >= scenario.duration) {
    findings.warning(*from_node, fmt::format("the {} begins at {} s, after the end of the run", what, *from),
                     fmt::format("the duration is {} s", scenario.duration));
  }
  return Span{*from, *until};
}

void read_pushes(Findings& findings, const YamlNode& node, Scenario& scenario) {
  for (const YamlNodePtr& push : read_list(findings, node, "pushes", "a list of pushes"))
    read_push(findings, *push, scenario);
}

void read_cameras(Findings& findings, const YamlNode& node, Scenario& scenario) {
  if (node.kind == YamlNode::Kind::scalar && node.text == "all") {
    scenario.cameras.reset();
    return;
  }
  scenario.cameras.emplace();
  if (node.kind == YamlNode::Kind::scalar && node.text == "none") return;
  for (const YamlNodePtr& camera : read_list(findings, node, "cameras", "all, none, or a list of Body/Camera"))
    read_camera(findings, *camera, scenario, *scenario.cameras);
}

void check_rates(Findings& findings, const YamlNode& bodies, const Scenario& scenario) {
  REHEARSE_ASSERT(bodies.items.size() == scenario.bodies.size(), "each entry without a mistake is a body");
  for (std::size_t i = 0; i < scenario.bodies.size(); ++i) {
    const ScenarioBody& body = scenario.bodies[i];
    for (const Device& device : body.model->devices) {
      const double rate = rate_of(device, body, scenario);
      if (rate * scenario.time_step <= 1.0 + 1e-9) continue;
      findings.warning(
          *bodies.items[i],
          fmt::format("{}/{} is to measure at {:.6g} Hz, but there are {:.6g} steps in a second: it measures "
                      "in each of them",
                      body.name, device.name, rate, 1.0 / scenario.time_step),
          "its update_rate is in the model");
    }
  }
}

void read_tolerances(Findings& findings, const YamlNode& node, Scenario& scenario) {
  for (const YamlNodePtr& rule : read_list(findings, node, "tolerances", "a list of tolerances, each with its channel"))
    read_tolerance(findings, *rule, scenario);
}

}  // namespace rehearse
