// Campaign: many runs of a scenario with other values of its varied parameters (`vary:`), each judged.
//
// A campaign is a folder: campaign.json (scenario, seed, options), plan.csv (the table of cases) and result lines.
// Everything but the result lines is immutable. A value of a random plan is a function of the campaign's seed, the
// number of the case and the name of the parameter. So a case is the same wherever it runs, and a new parameter changes
// no values of the others. In other plans it depends on the place of the parameter, too (`plan: sobol`), or on the
// number of cases (`plan: latin_hypercube`).
//
// Its cases are run by sweep.h, counted by campaign_report.h, and searched and shrunk by shrink.h.
#pragma once

#include <rehearse/check.h>
#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

enum class CaseVerdict {
  passed,
  violated,  // an expectation is violated
  differs,   // beyond the golden's tolerances
  failed,    // a controller threw, refused to take part, or tried to end the process
  crashed,   // a signal in a controller, or the end of the process
  hung,      // a call, or the whole case, exceeded its limit of wall time
  exploded,  // a position or velocity is no longer finite
  invalid,   // the scenario can't run with these values
};
inline constexpr std::size_t case_verdict_count = 8;

/// "passed", "violated", ...
std::string_view to_string(CaseVerdict verdict);

/// The result of one case. All members but `seconds` are functions of the case.
struct CaseResult {
  std::int64_t number = 0;  // from 0 on; -1: the nominal scenario
  CaseVerdict verdict = CaseVerdict::passed;
  std::string sentence;              // why it didn't pass; empty if it did
  std::string reason;                // the kind of failure: the expectation, or the sentence without its digits
  std::optional<std::int64_t> tick;  // the first tick that fails; none: passed, or the failure has no tick
  std::string hash;                  // of all messages of the run; empty: there was no run to its end
  std::int64_t ticks = 0;            // simulated
  std::vector<std::optional<double>> margins;  // by expectation, as ExpectationResult::margin
  std::vector<bool> reached = {};              // by condition of `sometimes`
  std::int64_t errors =
      0;  // of controllers: kinds of numbers that aren't finite, and error lines; the verdict may pass
  std::string first_error;  // the first of them; empty: none
  double seconds = 0.0;     // wall time [s]
  bool again = false;       // the second run of a case that the plan runs twice

  bool passed() const { return verdict == CaseVerdict::passed; }
  /// True if a run repeats this one: everything but the wall time is equal.
  bool repeats(const CaseResult& other) const;
};

/// The normal distribution that replaces the distribution of a parameter, within its bounds. For a parameter with
/// log_uniform it is the distribution of the logarithm.
struct SteeredParameter {
  std::string name;
  double mean = 0.0, stddev = 1.0;
};

struct CampaignOptions {
  std::int64_t cases = 0;  // 0: all combinations of the grids, or all rows of the files
  std::uint64_t seed = 0;
  std::filesystem::path golden;           // every case is compared with it; empty: no comparison
  int keep = 3;                           // number of traces kept of each kind of failure, of the lowest cases
  double case_limit = 600.0;              // wall time of a case; a longer case counts as hung [s]
  std::vector<SteeredParameter> steered;  // by a search; empty: all distributions are those of the scenario
  double own_share = 0.0;                 // of the values of each steered parameter, which aren't steered
  HostOptions host;
};

/// One of `count` equal parts of a campaign: the cases whose number divided by `count` leaves index - 1. It also
/// contains the second runs of the cases of the previous slice, so that another process makes them, perhaps on another
/// machine.
struct Slice {
  std::int64_t index = 1, count = 1;  // index from 1 on

  std::int64_t first_case() const { return index - 1; }
  std::int64_t first_second_run() const { return (index + count - 2) % count; }
};

/// A campaign's folder.
class Campaign {
 public:
  /// Fails if the folder is no campaign, if its plan was changed, or if the scenario or a model has changed since.
  static Result<Campaign> open(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  const Scenario& scenario() const { return scenario_; }
  const CampaignOptions& options() const { return options_; }
  const CaseResult& nominal() const { return nominal_; }
  const std::vector<std::string>& expectations() const { return expectations_; }  // as text
  const std::string& digest() const { return digest_; }                           // of plan.csv
  const std::map<std::string, std::string>& libraries() const {
    return libraries_;
  }  // of controllers, with their hashes

  /// The values of a case by variation, as text.
  std::vector<std::string> values_of(std::int64_t number) const;
  /// True if the plan runs the case a second time, in another process.
  bool runs_twice(std::int64_t number) const;
  /// The text of a case's scenario.
  Result<std::string> text_of(std::int64_t number) const;
  /// Fails if there is no such case.
  Result<void> check_number(std::int64_t number) const;

  /// Calls `take` for each result line, except for incomplete lines of a killed process.
  Result<void> read_results(const std::function<void(const CaseResult&)>& take) const;

  /// Of `count` slices, the indices (from 1 on) of those in which a case or a second run has no result.
  Result<std::vector<std::int64_t>> unfinished_slices(std::int64_t count) const;

  /// The values with those of linked parameters computed again. Empty values are nominal.
  std::vector<std::string> with_links(std::vector<std::string> values) const;

 private:
  friend class CampaignFolder;
  Campaign() = default;

  std::filesystem::path folder_;
  Scenario scenario_;
  CampaignOptions options_;
  CaseResult nominal_;
  std::map<std::string, std::string> libraries_;  // of controllers, with their hashes
  std::vector<std::string> expectations_;
  std::string digest_;
  std::shared_ptr<const class CaseValues> values_;
  bool is_new_ = false;  // this process has just run the nominal scenario
};

}  // namespace rehearse
