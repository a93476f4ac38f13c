#include "flight.h"

#include <rehearse/mcap.h>
#include <rehearse/pin.h>

#include <fstream>
#include <vector>

#include "core/guard/child_process.h"
#include "core/recording/mathematics.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"

namespace rehearse::tool {

std::optional<Flight> flight_in(const std::string& trace) {
  const auto reader = mcap::Reader::open(trace);
  if (!reader) return std::nullopt;  // its replay reports that
  const RunFacts facts = RunFacts::of(**reader);
  const auto scenario = facts.is_of_flight ? scenario_of(**reader) : Result<Scenario>(error(""));
  if (!scenario || scenario->bodies[0].controllers.empty()) return std::nullopt;
  Flight flight{scenario->bodies[0].controllers[0].name, facts.flight.value_or(mcap::StringMap()), {}};
  flight.other = other_mathematics(flight.facts);
  return flight;
}

void take_mathematics_of(const Flight& flight) {
  if (flight.other.empty() || !is_pinned() ||
      stated(flight.facts, flight_facts::mathematics) != mathematics_of_processor())
    return;
  std::ifstream stream("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(stream, word, '\0');) words.push_back(word);
  EnvironmentChanges changes{{"REHEARSE_PIN", "off"}, {"GLIBC_TUNABLES", std::nullopt}};
  if (const std::string tunables = stated(flight.facts, flight_facts::tunables); !tunables.empty())
    changes["GLIBC_TUNABLES"] = tunables;
  replace_process(own_program(), pointers_to(words).data(), changes);
}

std::string mathematics_line(const Flight& flight) {
  return flight.other.empty() ? "computed with the functions of the robot's libm"
                              : "this machine may round differently than the robot's: " + flight.other;
}

}  // namespace rehearse::tool
