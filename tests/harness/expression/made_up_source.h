// An artificial recording of three series and three links, for tests of expressions.
#pragma once

#include "base/glob.h"
#include "core/expression/expression.h"
#include "core/expression/joint_series.h"
#include "core/expression/name_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace rehearse {

/// Ticks from 0, 1 ms each. Robot/KNEE/q is the tick's number, Robot/KNEE/u ten times that; Robot/Walker/output/KNEE/u
/// is 5, and 6 replayed from tick 3 on. Robot/blank is NaN. The foot touches the floor in even ticks; each tenth tick
/// has the message "step". The foot's force is 650 N; the head is 1.5 m high and pitched by 0.5 rad.
class MadeUpSource : public ExpressionSource {
 public:
  static constexpr std::int64_t last = 100;  // tick
  enum Series { q, u, command, blank, odd, force, height, x, y, z, w };
  const std::vector<std::string> names{"Robot/KNEE/q",
                                       "Robot/KNEE/u",
                                       "Robot/Walker/output/KNEE/u",
                                       "Robot/blank",
                                       "Robot/odd name-1/x",
                                       "Robot/Foot/force",
                                       "Robot/HEAD/position/z",
                                       "Robot/HEAD/orientation/x",
                                       "Robot/HEAD/orientation/y",
                                       "Robot/HEAD/orientation/z",
                                       "Robot/HEAD/orientation/w"};
  const std::vector<std::string> links{"Robot/FOOT", "Robot/HEAD", "Floor/Floor"};

  Result<std::size_t> find_series(std::string_view name) override { return find_name(name, names, "series"); }
  bool is_replayed(std::size_t series) const override { return series == command; }
  bool has_replay() const override { return true; }
  Result<std::vector<std::size_t>> find_links(std::string_view name) override {
    if (name == "Robot") return std::vector<std::size_t>{0, 1};
    const auto found = find_name(name, links, "link");
    if (!found) return found.errors();
    return std::vector{*found};
  }
  std::string unit_of_series(std::size_t series) override { return series == force ? "N" : ""; }
  Result<std::size_t> find_joint_series(std::string_view joint, std::string_view quantity, bool of_command) override {
    return find_joint_name(joint, quantity, of_command, names);
  }
  Result<JointLimit> find_limit(std::string_view joint, std::string_view limit) override {
    if (joint == "KNEE" && limit == "effort") return JointLimit{1000.0, "N"};
    return error("there is no joint '" + std::string(joint) + "' with a limit");
  }
  std::int64_t last_tick() const override { return last; }
  double time_at(std::int64_t tick) const override { return static_cast<double>(tick) * 1e-3; }
  double value(std::size_t series, std::int64_t tick, CommandSide side) override {
    switch (series) {
      case q: return static_cast<double>(tick);
      case u: return static_cast<double>(tick) * 10.0;
      case command: return side == CommandSide::replayed && tick >= 3 ? 6.0 : 5.0;
      case odd: return 1.0;
      case force: return 650.0;
      case height: return 1.5;
      case x:
      case z: return 0.0;
      case y: return std::sin(0.25);
      case w: return std::cos(0.25);
      default: return std::numeric_limits<double>::quiet_NaN();
    }
  }
  bool touching(const std::vector<std::size_t>& some, const std::vector<std::size_t>& others,
                std::int64_t tick) override {
    const auto has = [](const std::vector<std::size_t>& ids, std::size_t id) {
      return std::ranges::find(ids, id) != ids.end();
    };
    const bool foot = has(some, 0) && (others.empty() || has(others, 2));
    const bool floor = has(some, 2) && (others.empty() || has(others, 0));
    return tick % 2 == 0 && (foot || floor);
  }
  bool differs_at(std::int64_t tick) override { return tick >= 3; }
  bool said(std::string_view pattern, std::int64_t tick) override { return tick % 10 == 0 && matches(pattern, "step"); }
  bool happened(std::string_view pattern, std::int64_t tick) override {
    return tick % 10 == 0 && matches(pattern, "note Robot: step");
  }
  double value_at(std::size_t series, double time, std::int64_t tick) override {
    const auto then = static_cast<std::int64_t>(time * 1e3 + 0.5);
    return then <= tick ? value(series, then, CommandSide::recorded) : std::numeric_limits<double>::quiet_NaN();
  }
};

}  // namespace rehearse
