// The results of a check's levels, and the result of the whole check.
#include <fmt/format.h>
#include <rehearse/check.h>

#include <algorithm>
#include <array>
#include <tuple>

namespace rehearse {

std::string_view to_string(LevelState state) {
  switch (state) {
    case LevelState::equal: return "equal";
    case LevelState::proved: return "proved";
    case LevelState::within: return "within";
    case LevelState::differs: return "differs";
    case LevelState::not_compared: return "not compared";
    case LevelState::no_golden: return "no golden";
  }
  return "";
}

bool CheckReport::equal() const {
  const bool any_within = std::ranges::count(std::array{controller, plant, closed}, LevelState::within) > 0;
  return within() && !any_within;
}

namespace {

/// The run of level closed is wrong, whatever the expectations demand.
bool is_wrong_without_expectations(const CheckReport& report) {
  return report.closed == LevelState::differs || report.closed == LevelState::no_golden || report.not_reproduced ||
         report.other_duration || report.proof_was_wrong || !report.other_physics.empty();
}

}  // namespace

bool CheckReport::within() const {
  return controller != LevelState::differs && plant != LevelState::differs && !run_is_wrong();
}

bool CheckReport::run_is_wrong() const { return is_wrong_without_expectations(*this) || first_violation(expectations); }

std::string levels_text(const CheckReport& report) {
  return fmt::format("controller: {}; plant: {}{}; closed: {}", to_string(report.controller), to_string(report.plant),
                     report.plant_until ? fmt::format(" up to tick {}", *report.plant_until) : "",
                     to_string(report.closed));
}

std::string tables_text(const CheckReport& report) {
  const auto below = [](const std::string& heading, const std::string& rows) {
    return rows.empty() ? rows : "  " + heading + ":\n" + rows;
  };
  std::string text;
  if (report.plant == LevelState::differs && report.plant_comparison)
    text += below("plant, under the golden's commands", table(*report.plant_comparison));
  if (report.comparison) text += below("closed, the whole run", table(*report.comparison));
  return text;
}

std::string bits_sentence(const CheckReport& report) {
  const auto& [first, bit] = std::tie(report.first, report.first_bit);
  return first && bit && bit->tick < first->tick ? fmt::format("its bits differ from tick {} on", bit->tick) : "";
}

bool CheckReport::undecided() const {
  const ExpectationResult* first = first_violation(expectations);
  return first && first->undecided && !failed() && controller != LevelState::differs && plant != LevelState::differs &&
         !is_wrong_without_expectations(*this);
}

bool CheckReport::failed() const {
  const bool run_failed = run && (run->failure || run->controller_refused);
  return run_failed || (replay && (replay->failure || replay->controller_refused));
}

}  // namespace rehearse
