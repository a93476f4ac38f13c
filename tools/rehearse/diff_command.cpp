// rehearse diff: compares two traces and reports their first difference.
#include <fmt/format.h>
#include <rehearse/compare.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "core/trace/align.h"
#include "options.h"
#include "output.h"
#include "scratch_folder.h"

namespace rehearse::tool {
namespace {

struct DiffSettings {
  std::string golden, actual;
  std::string beside;      // pictures are written beside this file
  std::string tolerances;  // a file; empty: those of the golden's scenario
  std::string align;       // "start" or a series; empty: both have the same clock
  bool pictures = false;
  bool json = false;
};

/// How much faster the clock of the second log is; negative: slower [ppm].
double parts_per_million_fast(const Alignment& alignment) { return (1.0 / (1.0 + alignment.drift) - 1.0) * 1e6; }

Json json_of_alignment(const Alignment& alignment, const std::string& by) {
  return {{"by", by},
          {"offset", static_cast<double>(alignment.offset) * 1e-9},
          {"drift", alignment.drift == 0.0 ? Json(nullptr) : Json(parts_per_million_fast(alignment))},
          {"correlation", alignment.correlation ? Json(*alignment.correlation) : Json(nullptr)},
          {"matched", alignment.matched},
          {"lone", {alignment.lone_first, alignment.lone_second}},
          {"left_out", alignment.left_out},
          {"median_distance", alignment.median_distance},
          {"largest_distance", alignment.largest_distance}};
}

std::string clock_text(const Alignment& alignment, const std::string& log) {
  const double offset = static_cast<double>(alignment.offset) * 1e-9;
  if (alignment.drift == 0.0) return fmt::format("the times of {} + {:.9f} s", log, offset);
  const double fast = parts_per_million_fast(alignment);
  constexpr double digits = 1e6;  // microseconds
  return fmt::format("the clock of {} is {:.12g} s {} at its start and {:.4g} ppm {} (by {} {})", log,
                     std::abs(std::round(offset * digits)) / digits, offset > 0.0 ? "behind" : "ahead", std::abs(fast),
                     fast < 0.0 ? "slow" : "fast", count_text(alignment.drift_pairs, "message"),
                     alignment.by_content ? "of equal content" : "in order");
}

std::string alignment_text(const Alignment& alignment, const DiffSettings& settings) {
  std::string text =
      fmt::format("aligned by {}{}: {}; {} matched, {:.3g} s apart (median; at most {:.3g} s)", settings.align,
                  alignment.correlation ? fmt::format(" (correlation {:.4f})", *alignment.correlation) : "",
                  clock_text(alignment, settings.actual), count_text(alignment.matched, "message"),
                  alignment.median_distance, alignment.largest_distance);
  if (alignment.lone_first + alignment.lone_second > 0)
    text += fmt::format("; without a match {} and {}", alignment.lone_first, alignment.lone_second);
  if (alignment.left_out > 0) text += fmt::format("; {} before time 0 left out", alignment.left_out);
  return text + "\n";
}

/// The tolerances of the trace's scenario. Without a scenario, only the defaults of the units apply.
Result<std::vector<ToleranceRule>> rules_of(const DiffSettings& settings, const Trace& golden) {
  return settings.tolerances.empty() ? tolerances_of(golden) : load_tolerances(settings.tolerances);
}

Exit compare_files(const DiffSettings& settings, const std::optional<Alignment>& alignment);

Exit run_diff(DiffSettings settings) {
  settings.beside = settings.actual;
  if (settings.align.empty()) return compare_files(settings, std::nullopt);
  const ScratchFolder folder = ScratchFolder::temporary();
  if (folder.path().empty()) return refuse(error("there is no folder for temporary files"));
  const std::filesystem::path aligned = folder.path() / "aligned.mcap";
  const auto alignment = write_aligned(settings.golden, settings.actual, settings.align, aligned);
  if (!alignment) return refuse(alignment.errors());
  if (!settings.json) fmt::print("{}", alignment_text(*alignment, settings));
  settings.actual = aligned.string();
  return compare_files(settings, *alignment);
}

Exit compare_files(const DiffSettings& settings, const std::optional<Alignment>& alignment) {
  const auto golden = Trace::outline(settings.golden);
  if (!golden) return refuse(golden.errors());
  const auto actual = Trace::outline(settings.actual);
  if (!actual) return refuse(actual.errors());
  for (const Trace* trace : {&*golden, &*actual})
    if (const auto known = check_version(*trace); !known) return refuse(known.errors());
  const auto rules = rules_of(settings, *golden);
  if (!rules) return refuse(rules.errors());
  const auto compared = compare(settings.golden, settings.actual, *rules);
  if (!compared) return refuse(compared.errors());
  const Comparison& comparison = *compared;
  if (comparison.within && comparison.values == 0)
    return refuse(error(fmt::format("nothing was compared: {} and {} have no message in common that is compared",
                                    settings.golden, settings.actual)));
  if (settings.json) {
    Json json = Json::parse(to_json(comparison));
    if (alignment) json["alignment"] = json_of_alignment(*alignment, settings.align);
    print(json);
  } else {
    fmt::print("{}\n{}", verdict(comparison), table(comparison));
  }
  if (settings.pictures) {
    const auto written = write_picture_differences(*golden, *actual, comparison, *rules, settings.beside);
    if (!written) return refuse(written.errors());
    if (!settings.json && !written->empty()) fmt::print("{}\n", picture_lines(written).substr(1));
  }
  return comparison.within ? Exit::done : Exit::differs;
}

std::function<Exit()> declare_diff(CLI::App& options) {
  const auto settings = std::make_shared<DiffSettings>();
  options.add_option("A", settings->golden, "the trace with the expected values; or a log, as info reads it")
      ->required()
      ->type_name("");
  options.add_option("B", settings->actual, "the trace with the actual values")->required()->type_name("");
  options.add_option("--tolerances", settings->tolerances, "YAML with a list of tolerances (those of A's scenario)")
      ->type_name("FILE");
  options
      .add_option("--align", settings->align,
                  "the logs have different clocks: start (of their first common topic), or a series by which the "
                  "offset is estimated. Messages are then matched by topic and order; stamps move with them")
      ->type_name("start|SERIES");
  options.add_flag(
      "--pictures", settings->pictures,
      "of each camera, the first picture beyond its tolerance: expected, actual and difference, as PNG beside B");
  add_json_flag(options, settings->json);
  return [settings] { return run_diff(*settings); };
}

}  // namespace

extern const Verb diff_verb{"diff",
                            "  rehearse diff golden/SR1.Stands.mcap today.mcap\n"
                            "  rehearse diff a.mcap b.mcap --tolerances loose.yaml --json\n"
                            "  rehearse diff a.mcap b.mcap --pictures\n"
                            "  rehearse diff monday/ friday/ --align l_knee/q\n",
                            declare_diff};

}  // namespace rehearse::tool
