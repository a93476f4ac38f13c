#include "compared_files.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "base/quiet_thread.h"
#include "compare_provenance.h"
#include "conclusion.h"
#include "core/trace/run_facts.h"
#include "core/trace/trace_windows.h"
#include "run_comparer.h"

namespace rehearse {

namespace {

/// The ends of the windows of two runs. A window ends before a tick, so that no tick is divided.
class WindowBorders {
 public:
  WindowBorders(const ComparedTraces& traces, std::uint64_t first, std::uint64_t last, std::size_t window_size)
      : traces_(traces), end_(last) {
    const double size = static_cast<double>(traces.golden_run.size + traces.actual_run.size);
    const double windows = std::max(1.0, size / static_cast<double>(window_size));
    step_ = static_cast<std::uint64_t>(static_cast<double>(last - first) / windows) + 1;
  }

  /// The end of the window that begins at this time, inclusive [ns].
  std::uint64_t after(std::uint64_t begin) const {
    if (end_ - begin <= step_) return end_;
    const TickClock& clock = traces_.clock.empty() ? traces_.actual_clock : traces_.clock;
    const auto tick = clock.next_time(begin + step_);
    return tick ? std::min(end_, *tick - 1) : begin + step_;
  }

 private:
  const ComparedTraces& traces_;
  const std::uint64_t end_;  // [ns]
  std::uint64_t step_ = 0;   // [ns]
};

/// A recording that is read in pieces; `samples`: the rate of the other recording's state, if that contains only
/// samples of it.
struct SurveyedFile {
  SurveyedFile(const std::filesystem::path& file, const std::optional<StateRate>& samples,
               const std::vector<ToleranceRule>& rules, std::vector<WatchedLimit> limits, std::size_t piece_size,
               Trace::Damage damage, const Trace::OnPiece& on_piece = {})
      : survey(rules, std::move(limits)), whole(read(file, samples, piece_size, damage, on_piece)) {
    if (whole) survey.finish(*whole);
  }
  SurveyedFile(const SurveyedFile&) = delete;
  SurveyedFile& operator=(const SurveyedFile&) = delete;

  RunSurvey survey;
  const Result<Trace> whole;

 private:
  Result<Trace> read(const std::filesystem::path& file, const std::optional<StateRate>& samples, std::size_t piece_size,
                     Trace::Damage damage, const Trace::OnPiece& on_piece) {
    const auto take = [&](const Trace& piece) {
      survey.take(piece);
      if (on_piece) on_piece(piece);
    };
    return load_for_comparison(file, samples ? &*samples : nullptr, take, piece_size, damage);
  }
};

/// The largest lead and lag of all rules [ns].
std::pair<std::uint64_t, std::uint64_t> largest_lead_and_lag(const std::vector<ToleranceRule>& rules) {
  double lead = 0.0, lag = 0.0;
  for (const ToleranceRule& rule : rules) {
    lead = std::max(lead, rule.lead.value_or(0.0));
    lag = std::max(lag, rule.lag.value_or(0.0));
  }
  return {static_cast<std::uint64_t>(std::ceil(lead * 1e9)), static_cast<std::uint64_t>(std::ceil(lag * 1e9))};
}

/// The windows of some channels of a recording, from a second on [ns].
TraceWindows windows_from(std::uint64_t second, const RunSurvey& run,
                          const std::vector<const TraceChannel*>& channels) {
  std::vector<std::size_t> indices;
  WindowsStart start{second, {}};
  for (const TraceChannel* channel : channels) {
    indices.push_back(run.index_of(*channel));
    start.earlier.push_back(run.of(*channel).messages_before(second));
  }
  return {run.whole(), indices, start};
}

/// Reads the differing parts of two recordings once more, and compares them.
Result<void> compare_windows(RunComparer& comparer, std::size_t window_size, Trace::Damage damage) {
  const ComparedTraces& traces = comparer.traces();
  std::vector<const TraceChannel*> of_golden, of_actual;
  constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t first = never, last = 0, equal_until = never;
  for (const PairedChannel& channel : comparer.channels()) {
    of_golden.push_back(&channel.golden);
    of_actual.push_back(&channel.actual);
    first = std::min({first, channel.golden_survey.first_time, channel.actual_survey.first_time});
    last = std::max({last, channel.golden_survey.last_time, channel.actual_survey.last_time});
    equal_until = std::min(equal_until, rehearse::equal_until(channel.golden_survey, channel.actual_survey));
  }
  last = std::min(last, traces.end);
  if (first > last) return {};
  const auto [lead, lag] = largest_lead_and_lag(traces.rules);
  const WindowBorders borders(traces, first, last, window_size);
  equal_until = std::min(equal_until, second_of(last));
  comparer.skip_to(equal_until);
  std::uint64_t begin = std::max(first, equal_until);
  TraceWindows golden_windows =
      windows_from(second_of(equal_until - std::min(equal_until, lag)), traces.golden_run, of_golden);
  TraceWindows actual_windows = windows_from(equal_until, traces.actual_run, of_actual);
  for (std::uint64_t end = 0; begin <= last; begin = end + 1) {
    end = borders.after(begin);
    golden_windows.move(begin - std::min(begin, lag), end + lead);
    actual_windows.move(begin, end);
    comparer.take({golden_windows.window(), actual_windows.window(), begin, end});
  }
  if (damage == Trace::Damage::tolerate) return {};
  for (TraceWindows* windows : {&golden_windows, &actual_windows}) REHEARSE_TRY(windows->verdict());
  return {};
}

}  // namespace

Result<ComparedFiles> compare_files(const std::filesystem::path& golden, const std::filesystem::path& actual,
                                    const std::vector<ToleranceRule>& rules, const CompareOptions& options,
                                    const Trace::OnPiece& on_actual, std::size_t window_size, Trace::Damage damage) {
  const auto golden_outline = REHEARSE_TRY(Trace::outline(golden));
  const auto actual_outline = REHEARSE_TRY(Trace::outline(actual));
  for (const Trace* trace : {&golden_outline, &actual_outline})
    if (const auto known = check_version(*trace); !known)
      return ComparedFiles{refusal(known.errors()[0]), actual_outline};
  WatchedLimits limits(golden_outline, actual_outline);
  const auto of_golden = RunFacts::of(golden_outline).state_rate, of_actual = RunFacts::of(actual_outline).state_rate;
  std::optional<SurveyedFile> golden_file;
  std::thread reads_golden = start_quiet_thread(
      [&] { golden_file.emplace(golden, of_actual, rules, std::move(limits.golden), window_size, damage); });
  const SurveyedFile actual_file(actual, of_golden, rules, std::move(limits.actual), window_size, damage, on_actual);
  reads_golden.join();
  if (!golden_file->whole) return golden_file->whole.errors();
  if (!actual_file.whole) return actual_file.whole.errors();
  RunComparer comparer(golden_file->survey, actual_file.survey, rules, options);
  REHEARSE_TRY(compare_windows(comparer, window_size, damage));
  Comparison comparison = comparer.finish();
  return ComparedFiles{std::move(comparison), *actual_file.whole};
}

Result<Comparison> compare(const std::filesystem::path& golden, const std::filesystem::path& actual,
                           const std::vector<ToleranceRule>& rules, const CompareOptions& options,
                           std::size_t window_size) {
  auto compared = REHEARSE_TRY(compare_files(golden, actual, rules, options, {}, window_size));
  return std::move(compared.comparison);
}

}  // namespace rehearse
