// rehearse diff: compares two traces and reports their first difference.
#include <fmt/format.h>
#include <rehearse/compare.h>

#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "options.h"
#include "output.h"

namespace rehearse::tool {
namespace {

struct DiffSettings {
  std::string golden, actual;
  std::string tolerances;  // a file; empty: those of the golden's scenario
  bool pictures = false;
  bool json = false;
};

/// The tolerances of the trace's scenario. Without a scenario, only the defaults of the units apply.
Result<std::vector<ToleranceRule>> rules_of(const DiffSettings& settings, const Trace& golden) {
  return settings.tolerances.empty() ? tolerances_of(golden) : load_tolerances(settings.tolerances);
}

Exit run_diff(const DiffSettings& settings) {
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
    print(Json::parse(to_json(comparison)));
  } else {
    fmt::print("{}\n{}", verdict(comparison), table(comparison));
  }
  if (settings.pictures) {
    const auto written = write_picture_differences(*golden, *actual, comparison, *rules, settings.actual);
    if (!written) return refuse(written.errors());
    if (!settings.json && !written->empty()) fmt::print("{}\n", picture_lines(written).substr(1));
  }
  return comparison.within ? Exit::done : Exit::differs;
}

std::function<Exit()> declare_diff(CLI::App& options) {
  const auto settings = std::make_shared<DiffSettings>();
  options.add_option("A", settings->golden, "the trace with the expected values")->required()->type_name("");
  options.add_option("B", settings->actual, "the trace with the actual values")->required()->type_name("");
  options.add_option("--tolerances", settings->tolerances, "YAML with a list of tolerances (those of A's scenario)")
      ->type_name("FILE");
  options.add_flag(
      "--pictures", settings->pictures,
      "of each camera, the first picture beyond its tolerance: expected, actual and difference, as PNG beside B");
  add_json_flag(options, settings->json);
  return [settings] { return run_diff(*settings); };
}

}  // namespace

const Verb diff_verb{"diff",
                     "  rehearse diff golden/SR1.Stands.mcap today.mcap\n"
                     "  rehearse diff a.mcap b.mcap --tolerances loose.yaml --json\n"
                     "  rehearse diff a.mcap b.mcap --pictures\n",
                     declare_diff};

}  // namespace rehearse::tool
