// sweep --towards: rounds of campaigns, steered towards the failure of an expectation.
#include <fmt/format.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/guard/interruption.h"
#include "output.h"
#include "progress.h"
#include "side_by_side.h"
#include "sweep.h"

namespace rehearse::tool {
namespace {

Json json_of(const FailureProbability& probability) {
  return {{"estimate", probability.estimate},
          {"interval", {probability.interval.low, probability.interval.high}},
          {"cases", probability.cases},
          {"violations", probability.violations},
          {"enough", probability.has_enough_violations},
          {"folder", probability.folder.string()}};
}

std::string sentence_on(const FailureProbability& probability) {
  const std::string cases = fmt::format("{} of {} steered cases violate it", probability.violations, probability.cases);
  if (probability.violations == 0)
    return fmt::format("the probability of a violation is at most {:.3g}, with 95 % confidence: {}",
                       probability.interval.high, cases);
  if (!probability.has_enough_violations)
    return fmt::format(
        "not enough cases that fail: the probability of a violation is about {:.3g}, and at most {:.3g}, with 95 % "
        "confidence: {}, by their weights fewer than ten (--estimate with more cases)",
        probability.estimate, probability.interval.high, cases);
  return fmt::format("the probability of a violation is about {:.3g} ({:.3g} to {:.3g}, with 95 % confidence): {}",
                     probability.estimate, probability.interval.low, probability.interval.high, cases);
}

/// Prints the rounds, and the way to the first failure.
Exit tell(const SearchResult& result, bool json) {
  const std::vector<SearchRound>& rounds = result.rounds;
  std::vector<TableRow> rows{{"round", "cases", "violations", "least margin"}};
  Json list = Json::array();
  const SearchRound* failing = nullptr;
  for (const SearchRound& round : rounds) {
    rows.push_back({round.folder.filename().string(), fmt::format("{}", round.summary.judged()),
                    fmt::format("{}", round.violations), fmt::format("{:.4g}", round.least_margin)});
    list.push_back({{"folder", round.folder.string()},
                    {"cases", round.summary.judged()},
                    {"failed", round.summary.failed()},
                    {"violations", round.violations},
                    {"least_margin", round.least_margin},
                    {"first_failure", round.first_failure ? Json(*round.first_failure) : Json(nullptr)}});
    if (!failing && round.first_failure) failing = &round;
  }
  if (json) {
    print({{"rounds", std::move(list)},
           {"probability", result.probability ? json_of(*result.probability) : Json(nullptr)}});
  } else {
    print_table(rows);
    if (failing)
      fmt::print("case {} violates it: rehearse sweep shrink {} {}\n", *failing->first_failure, *failing->first_failure,
                 failing->folder.string());
    else
      fmt::print("no case violates it\n");
    if (result.probability) fmt::print("{}\n", sentence_on(*result.probability));
  }
  return failing ? Exit::differs : Exit::done;
}

}  // namespace

Exit run_search(SweepSettings& settings) {
  settings.sweep.jobs = settings.jobs > 0 ? static_cast<std::size_t>(settings.jobs) : processors();
  constexpr std::int64_t all = std::numeric_limits<std::int64_t>::max();
  if (settings.sweep.most_failures != all)  // of all rounds; a round is always finished
    settings.search.most_failures = std::exchange(settings.sweep.most_failures, all);
  const auto rounds = [&] {
    Progress progress("searching");
    settings.sweep.progress = [&](const SweepProgress& now) {
      progress.set_text(fmt::format("searching: {} of {} cases of a round, {} failed", now.done, now.all, now.failed));
      progress.show(now.done, now.all);
      return true;
    };
    return search(settings.scenario, settings.folder, settings.campaign, settings.search, settings.sweep, simulation());
  }();
  if (!rounds && interruption() != 0) {
    fmt::print(stderr, "interrupted; the same command continues\n");
    return static_cast<Exit>(128 + interruption());
  }
  return rounds ? tell(*rounds, settings.json) : refuse(rounds.errors());
}

}  // namespace rehearse::tool
