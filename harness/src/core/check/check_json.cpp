// A check's report as JSON.
#include "check_json.h"

#include "core/compare/report_json.h"

namespace rehearse {
namespace {

nlohmann::ordered_json or_null(const std::optional<Comparison>& comparison) {
  return comparison ? json_of(*comparison) : nlohmann::ordered_json();
}

nlohmann::ordered_json json_of(const ClosestPlace& closest) {
  return {{"margin", number_json(closest.margin)},
          {"value", number_json(closest.value)},
          {"bound", number_json(closest.bound)},
          {"unit", closest.unit},
          {"share", closest.share ? number_json(*closest.share) : nlohmann::ordered_json()},
          {"tick", closest.tick},
          {"time", closest.time},
          {"text", closest.text}};
}

}  // namespace

nlohmann::ordered_json json_of(const ExpectationResult& result) {
  nlohmann::ordered_json object{{"text", result.text},
                                {"line", result.expectation.place.line},
                                {"holds", result.holds},
                                {"first", nullptr},
                                {"undecided", result.undecided},
                                {"not_judged", result.not_judged},
                                {"formula", result.formula},
                                {"margin", result.margin ? number_json(*result.margin) : nlohmann::ordered_json()},
                                {"closest", nullptr}};
  if (result.closest) object["closest"] = json_of(*result.closest);
  if (result.first)
    object["first"] = {{"series", result.series},
                       {"tick", result.first->tick},
                       {"time", result.first->time},
                       {"value", result.first->value ? number_json(*result.first->value) : nlohmann::ordered_json()}};
  return object;
}

nlohmann::ordered_json json_of(const ReplayReport& replayed) {
  return {{"first", json_of(replayed.first)},
          {"beyond", json_of(replayed.beyond)},
          {"worst", json_of(replayed.worst)},
          {"ticks", replayed.ticks},
          {"ticks_different", replayed.ticks_different},
          {"values", replayed.values},
          {"values_different", replayed.values_different}};
}

nlohmann::ordered_json json_of(const CheckReport& report) {
  nlohmann::ordered_json object{
      {"verdict", report.verdict.text()},
      {"code", report.verdict.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(report.verdict.code())},
      {"codes", nlohmann::ordered_json::array()},
      {"equal", report.equal()},
      {"within", report.within()},
      {"not_reproduced", report.not_reproduced},
      {"proved", report.proved},
      {"simulated_from", nullptr},
      {"not_proved", nullptr},
      {"levels",
       {{"controller", to_string(report.controller)},
        {"plant", to_string(report.plant)},
        {"closed", to_string(report.closed)}}},
      {"first", json_of(report.first)},
      {"comparisons",
       {{"controller", report.replay ? json_of(*report.replay) : nlohmann::ordered_json()},
        {"plant", or_null(report.plant_comparison)},
        {"closed", or_null(report.comparison)}}},
      {"horizon", nullptr},
      {"expectations", nlohmann::ordered_json::array()},
      {"remarks", report.remarks}};
  for (const VerdictCode code : report.verdict.codes()) object["codes"].push_back(to_string(code));
  if (report.simulated_from) object["simulated_from"] = *report.simulated_from;
  if (!report.not_proved.empty()) object["not_proved"] = report.not_proved;
  if (report.horizon) object["horizon"] = *report.horizon;
  for (const ExpectationResult& result : report.expectations) object["expectations"].push_back(json_of(result));
  return object;
}

std::string to_json(const CheckReport& report) { return text_of(json_of(report)); }

}  // namespace rehearse
