// Ten planted faults that show only in a corner of the space of eight parameters: a campaign finds each, and shrinks it
// to the parameters responsible.
#include "command.h"

#include <algorithm>
#include <set>

namespace rehearse::test {
namespace {

using Names = std::set<std::string>;

class Corners : public Command {
 protected:
  fs::path scenario(int fault) const {
    const std::string n = std::to_string(fault);
    return write("corner" + n + ".yaml", R"(rehearse: 1
duration: 0.4
bodies:
  - name: Pendulum
    model: )" + (fixtures / "models/pendulum.urdf").string() +
                                             R"(
    joints: {hinge: 0}
    controllers:
      - name: Hold
        library: )" CORNERS R"(
        options: "{stiffness: 60, damping: 6, ramp: 0.05, limit: 80, gain: 1, offset: 0, fault: )" +
                                             n + R"(}"
pushes:
  - {body: Pendulum, link: rod, at: [0, 0, -1], force: [0.001, 0, 0], from: 0.25, until: 0.27}
vary:
  angle: {path: bodies.Pendulum.joints.hinge, uniform: [-0.3, 0.3]}
  push: {path: "pushes[0].force[0]", normal: {mean: 0, stddev: 50, from: -120, to: 120}}
  stiffness: {path: bodies.Pendulum.controllers.Hold.options.stiffness, uniform: [30, 90]}
  damping: {path: bodies.Pendulum.controllers.Hold.options.damping, uniform: [2, 10]}
  ramp: {path: bodies.Pendulum.controllers.Hold.options.ramp, uniform: [0.01, 0.1]}
  limit: {path: bodies.Pendulum.controllers.Hold.options.limit, uniform: [60, 95]}
  gain: {path: bodies.Pendulum.controllers.Hold.options.gain, uniform: [0.8, 1.2]}
  offset: {path: bodies.Pendulum.controllers.Hold.options.offset, uniform: [-0.1, 0.1]}
expect:
  - {channel: Pendulum/hinge/u, abs: true, below: 96}
  - {channel: Pendulum/hinge/q, abs: true, below: 1.5}
  - {no_event: "* error: *"}
)");
  }

  /// The parameters to which the first failing case is shrunk; empty: none fails, or the sentence is another one.
  Names found(int fault) {
    const std::string campaign = "campaign" + std::to_string(fault);
    const Outcome swept =
        rehearse({"sweep", scenario(fault).string(), "--cases", "250", "--seed", "7", "-o", campaign, "--keep", "0"});
    EXPECT_EQ(swept.status, 1) << fault << ": " << swept.out << swept.err;
    const auto report = nlohmann::json::parse(read_file(folder() / campaign / "report.json"), nullptr, false);
    if (report.is_discarded() || report["failures"].empty()) return {};
    EXPECT_EQ(report["nominal"]["verdict"], "passed") << fault;
    const auto& failure = report["failures"][0];
    const std::string number = std::to_string(failure["cases"][0].get<int>());
    const auto shrunk = rehearse({"sweep", "shrink", number, campaign, "--json"}).json();
    if (shrunk.is_null() || !shrunk.contains("differs")) return {};
    EXPECT_TRUE(shrunk["finished"]) << fault;
    EXPECT_EQ(shrunk["verdict"], failure["verdict"]) << fault;
    const Outcome again = rehearse({"record", campaign + "/shrunk-" + number + ".yaml", "-o", "again.mcap"});
    const std::string sentence = shrunk["sentence"];
    EXPECT_NE((again.out + again.err).find(sentence), std::string::npos) << fault << ": " << sentence << "\n"
                                                                         << again.out << again.err;
    Names names;
    for (const auto& [name, value] : shrunk["differs"].items()) names.insert(name);
    return names;
  }
};

TEST_F(Corners, AreFoundAndShrunkToTheParametersResponsible) {
  const std::vector<Names> responsible{
      {"stiffness", "damping"}, {"ramp", "limit"}, {"gain", "stiffness"}, {"angle", "stiffness"}, {"offset", "damping"},
      {"push", "limit"},        {"ramp", "gain"},  {"push", "damping"},   {"offset", "ramp"},     {"gain", "offset"},
  };
  const int last = AT_NIGHT ? 10 : 1;
  int right = 0;
  for (int fault = 1; fault <= last; ++fault) {
    const Names names = found(fault);
    const Names& expected = responsible[static_cast<std::size_t>(fault - 1)];
    const bool is_right = names == expected;
    right += is_right ? 1 : 0;
    std::string text;
    for (const std::string& name : names) text += " " + name;
    if (!is_right) std::cout << "fault " << fault << ":" << text << "\n";
  }
  EXPECT_GE(right, AT_NIGHT ? 9 : 1);
}

}  // namespace
}  // namespace rehearse::test
