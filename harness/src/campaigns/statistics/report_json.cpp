#include "report_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace rehearse {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json_of(const Interval& interval) { return Json::array({interval.low, interval.high}); }

Json texts_of(const std::vector<ViolatingRange>& ranges) {
  Json texts = Json::array();
  for (const ViolatingRange& range : ranges) texts.push_back(to_string(range));
  return texts;
}

Json json_of_faults(const std::vector<FaultRow>& rows) {
  Json list = Json::array();
  for (const FaultRow& row : rows) {
    Json cells = Json::array();
    for (const FaultCell& cell : row.cells)
      cells.push_back({{"expectation", cell.expectation},
                       {"survives", cell.survives()},
                       {"holds", cell.holds},
                       {"violated", cell.violated},
                       {"unjudged", cell.unjudged},
                       {"least_margin", cell.least_margin ? Json(*cell.least_margin) : Json(nullptr)},
                       {"violated_with", texts_of(cell.violated_with)},
                       {"text", to_string(cell)}});
    list.push_back({{"fault", to_string(row.fault)}, {"cases", row.cases}, {"expectations", std::move(cells)}});
  }
  return list;
}

Json json_of_non_inferiority(const CampaignSummary& summary) {
  if (!summary.non_inferiority) return nullptr;
  const NonInferiority& claim = *summary.non_inferiority;
  const auto more = more_pairs(claim, *summary.pairs);
  return {{"margin", claim.margin},
          {"confidence", claim.confidence},
          {"difference", number_or_null(summary.pairs->difference())},
          {"interval", json_of(paired_interval(*summary.pairs, claim.confidence))},
          {"answer", std::string(to_string(answer_of(claim, *summary.pairs)))},
          {"more_cases", or_null(more)}};
}

Json json_of_claim(const CampaignSummary& summary) {
  if (!summary.claim) return nullptr;
  const auto more = summary.more_cases();
  return {{"at_least", summary.claim->at_least},
          {"confidence", summary.claim->confidence},
          {"answer", std::string(to_string(summary.rate_answer()))},
          {"more_cases", or_null(more)}};
}

Json json_of_summary(const CampaignSummary& summary) {
  Json verdicts = Json::object();
  for (std::size_t i = 0; i < case_verdict_count; ++i)
    verdicts[std::string(to_string(static_cast<CaseVerdict>(i)))] = summary.verdicts[i];
  Json reached = Json::object();
  for (const auto& [name, count] : summary.reached) reached[name] = count;
  return {{"verdict", verdict(summary)},
          {"claim", json_of_claim(summary)},
          {"non_inferiority", json_of_non_inferiority(summary)},
          {"reached", reached},
          {"cases", summary.cases},
          {"verdicts", verdicts},
          {"missing", summary.missing},
          {"share", number_or_null(summary.share())},
          {"interval", json_of(summary.interval())},
          {"until_failures", summary.until_failures > 0 ? Json(summary.until_failures) : Json(nullptr)},
          {"with_errors", summary.with_errors},
          {"passed_with_errors", summary.passed_with_errors},
          {"faults", json_of_faults(summary.faults)},
          {"repeated", summary.repeated},
          {"unrepeated", summary.unrepeated}};
}

Json json_of(const FailureKind& failure) {
  return {{"reason", failure.reason},
          {"verdict", std::string(to_string(failure.verdict))},
          {"count", failure.count},
          {"sentence", failure.sentence},
          {"cases", failure.cases}};
}

Json json_of(const ErrorKind& error) {
  return {{"error", error.error},
          {"count", error.count},
          {"passed", error.passed},
          {"example", error.example},
          {"cases", error.cases}};
}

Json json_of(const std::optional<OfMargin>& margin) {
  if (!margin) return nullptr;
  return {{"expectation", margin->expectation}, {"correlation", margin->number}};
}

Json json_of(const std::optional<IndexOfMargin>& margin) {
  if (!margin) return nullptr;
  return {{"expectation", margin->expectation},
          {"share", margin->index.share},
          {"interval", json_of(margin->index.interval)}};
}

Json json_of(const WordShare& word) {
  return {{"word", word.word},
          {"cases", word.cases},
          {"passed", word.passed},
          {"share", or_null(word.share)},
          {"interval", json_of(word.interval)}};
}

Json json_of(const ParameterFindings& parameter) {
  const auto& of_passing = parameter.importance_of_passing;
  Json object{{"name", parameter.name},
              {"path", parameter.path},
              {"nominal", parameter.nominal},
              {"correlation_with_passing", or_null(parameter.correlation_with_passing)},
              {"correlation_with_margin", json_of(parameter.correlation_with_margin)},
              {"importance",
               {{"passing", of_passing ? Json(of_passing->share) : Json(nullptr)},
                {"passing_interval", of_passing ? json_of(of_passing->interval) : Json(nullptr)},
                {"margin", json_of(parameter.importance_of_margin)}}},
              {"median_of_passed", or_null(parameter.median_of_passed)},
              {"median_of_failed", or_null(parameter.median_of_failed)}};
  if (!parameter.has_words) return object;
  object["association_with_passing"] = or_null(parameter.association_with_passing);
  object["words"] = Json::array();
  for (const WordShare& word : parameter.words) object["words"].push_back(json_of(word));
  return object;
}

Json json_of(const MarginFindings& margin) {
  Json worst = Json::array();
  for (const auto& [number, distance] : margin.worst_passes) worst.push_back({{"case", number}, {"margin", distance}});
  return {{"expectation", margin.expectation},
          {"least", or_null(margin.least)},
          {"percentile_5", or_null(margin.percentile_5)},
          {"median", or_null(margin.median)},
          {"largest", or_null(margin.largest)},
          {"worst_passes", worst}};
}

Json json_of(const UnvisitedCells& cells) {
  return {{"parameters", cells.parameters},
          {"cells", cells.cells},
          {"unvisited", cells.unvisited},
          {"examples", cells.examples}};
}

Json json_of(const CampaignChange& change) {
  return {{"compared", change.pairs.all},
          {"same_bits", change.same_bits},
          {"broken", change.pairs.broken},
          {"mended", change.pairs.mended},
          {"p", change.p},
          {"difference", or_null(change.difference)},
          {"interval", json_of(change.interval)},
          {"broken_cases", change.broken_cases},
          {"mended_cases", change.mended_cases},
          {"differences", change.differences}};
}

template <class T>
Json json_of_list(const std::vector<T>& list) {
  Json array = Json::array();
  for (const T& each : list) array.push_back(json_of(each));
  return array;
}

}  // namespace

std::string to_json(const CampaignSummary& summary) { return json_of_summary(summary).dump(); }

std::string json_of(const CampaignFindings& findings) {
  Json report{{"schema", 1},
              {"scenario", findings.scenario},
              {"seed", findings.seed},
              {"plan", findings.plan},
              {"summary", json_of_summary(findings.summary)},
              {"nominal",
               {{"verdict", std::string(to_string(findings.nominal.verdict))},
                {"sentence", findings.nominal.sentence},
                {"hash", findings.nominal.hash}}},
              {"failures", json_of_list(findings.failures)},
              {"errors", json_of_list(findings.errors)},
              {"parameters", json_of_list(findings.parameters)},
              {"margins", json_of_list(findings.margins)},
              {"cells", json_of_list(findings.cells)}};
  if (findings.against) report["against"] = json_of(*findings.against);
  return report.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace rehearse
