// One case of a campaign: recorded again, or shrunk.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/guard/interruption.h"
#include "output.h"
#include "progress.h"
#include "sweep.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

Json json_of_result(const Campaign& campaign, const CaseResult& result) {
  Json margins = Json::array();
  for (std::size_t i = 0; i < std::min(result.margins.size(), campaign.expectations().size()); ++i)
    margins.push_back({{"expectation", campaign.expectations()[i]},
                       {"margin", result.margins[i] ? number_json(*result.margins[i]) : Json(nullptr)}});
  return {{"verdict", std::string(to_string(result.verdict))},
          {"sentence", result.sentence},
          {"tick", result.tick ? Json(*result.tick) : Json(nullptr)},
          {"ticks", result.ticks},
          {"hash", result.hash},
          {"margins", margins}};
}

/// The first result of a case; none: it has none.
Result<std::optional<CaseResult>> kept_result(const Campaign& campaign, std::int64_t number) {
  std::optional<CaseResult> found;
  REHEARSE_TRY(campaign.read_results([&](const CaseResult& result) {
    if (result.number == number && !result.again && !found) found = result;
  }));
  return found;
}

void tell_values(const Campaign& campaign, const std::vector<std::string>& values) {
  const std::vector<Variation>& variations = campaign.scenario().variations;
  std::vector<TableRow> rows{{"parameter", "value", "nominal"}};
  for (std::size_t i = 0; i < values.size(); ++i)
    rows.push_back({variations[i].name, plain_text(values[i].empty() ? variations[i].nominal : values[i]),
                    plain_text(variations[i].nominal)});
  print_table(rows);
}

Json json_of_values(const Campaign& campaign, const std::vector<std::string>& values) {
  Json object = Json::object();
  for (std::size_t i = 0; i < values.size(); ++i) object[campaign.scenario().variations[i].name] = values[i];
  return object;
}

/// After a rebuild a case may end differently than in the campaign.
void tell_changed(const std::vector<std::string>& controllers) {
  for (const std::string& controller : controllers)
    fmt::print(stderr, "warning: the controller {} has changed since the campaign began\n", controller);
}

/// "the same bits as in the campaign", or the difference.
std::string agreement(const std::optional<CaseResult>& kept, const CaseResult& now) {
  if (!kept) return "the campaign has no result of it yet";
  if (kept->repeats(now)) return "the same bits as in the campaign";
  return fmt::format("other bits than in the campaign ({})",
                     kept->hash.empty() ? std::string(to_string(kept->verdict)) : kept->hash);
}

}  // namespace

Exit run_case_again(SweepSettings& settings) {
  end_runs_on_signals();
  const auto campaign = Campaign::open(settings.folder);
  if (!campaign) return refuse(campaign.errors());
  if (const auto there = campaign->check_number(settings.number); !there) return refuse(there.errors());
  const auto kept = kept_result(*campaign, settings.number);
  if (!kept) return refuse(kept.errors());
  const auto text = campaign->text_of(settings.number);
  if (!text) return refuse(text.errors());
  const fs::path trace = settings.output.empty()
                             ? campaign->folder() / "traces" / fmt::format("case-{}.mcap", settings.number)
                             : fs::path(settings.output);
  const auto run = run_text(*campaign, *text, trace, simulation());
  if (!run) return refuse(run.errors());
  const CaseResult* const result = &run->result;
  const std::string same = agreement(*kept, *result);
  if (settings.json) {
    Json object = json_of_result(*campaign, *result);
    object["case"] = settings.number;
    object["values"] = json_of_values(*campaign, campaign->values_of(settings.number));
    object["trace"] = trace.string();
    object["same"] = *kept ? Json((*kept)->repeats(*result)) : Json(nullptr);
    object["changed_controllers"] = run->changed;
    print(object);
  } else {
    tell_values(*campaign, campaign->values_of(settings.number));
    fmt::print("case {}: {}{}\n{}\n{}\n", settings.number, to_string(result->verdict),
               result->sentence.empty() ? "" : ": " + plain_text(result->sentence), same, trace.string());
  }
  std::fflush(stdout);
  tell_changed(run->changed);
  return *kept && !(*kept)->repeats(*result) ? Exit::differs : Exit::done;
}

namespace {

void tell_shrunk(const Campaign& campaign, const Shrunk& shrunk, const fs::path& file) {
  std::vector<TableRow> rows{{"parameter", "value", "nominal"}};
  for (const std::size_t i : shrunk.differs)
    rows.push_back({campaign.scenario().variations[i].name, plain_text(shrunk.values[i]),
                    plain_text(campaign.scenario().variations[i].nominal)});
  print_table(rows);
  fmt::print("{} of {} parameters differ, {:g} s of simulation, after {} runs{}\n", shrunk.differs.size(),
             campaign.scenario().variations.size(), shrunk.duration, shrunk.runs,
             shrunk.finished ? "" : "; the search isn't finished");
  fmt::print("{}: {}\n", to_string(shrunk.result.verdict), plain_text(shrunk.result.sentence));
  fmt::print("{}\n{}\n", file.string(), fs::path(file).replace_extension(".mcap").string());
}

}  // namespace

Exit run_shrink(SweepSettings& settings) {
  end_runs_on_signals();
  const auto campaign = Campaign::open(settings.folder);
  if (!campaign) return refuse(campaign.errors());
  const auto shrunk = [&] {
    Progress progress("shrinking");
    settings.shrink.progress = [&](int runs, std::size_t differing) {
      progress.set_text(fmt::format("shrinking: {} runs, {} differ", runs, count_text(differing, "parameter")));
      progress.show(runs, settings.shrink.budget);
      return true;
    };
    return shrink(*campaign, settings.number, settings.shrink, simulation());
  }();
  if (!shrunk) return refuse(shrunk.errors());
  const fs::path file = settings.output.empty() ? campaign->folder() / fmt::format("shrunk-{}.yaml", settings.number)
                                                : fs::path(settings.output);
  if (interruption() == 0) {
    if (const auto written = write_shrunk(*campaign, *shrunk, file, simulation()); !written)
      return refuse(written.errors());
  } else if (const auto written = write_shrunk(*campaign, *shrunk, file, {}); !written) {
    return refuse(written.errors());
  }
  if (settings.json) {
    Json object = json_of_result(*campaign, shrunk->result);
    object["case"] = settings.number;
    Json values = Json::object();
    for (const std::size_t i : shrunk->differs) values[campaign->scenario().variations[i].name] = shrunk->values[i];
    object["differs"] = values;
    object["duration"] = shrunk->duration;
    object["runs"] = shrunk->runs;
    object["finished"] = shrunk->finished;
    object["scenario"] = file.string();
    object["changed_controllers"] = shrunk->changed;
    print(object);
  } else {
    tell_shrunk(*campaign, *shrunk, file);
  }
  std::fflush(stdout);
  tell_changed(shrunk->changed);
  return Exit::done;
}

}  // namespace rehearse::tool
