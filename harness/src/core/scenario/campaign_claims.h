// The keys of a scenario that are for its campaigns: `plan`, `pass_rate` and `sometimes`. A single run ignores them.
#pragma once

#include <rehearse/scenario.h>

#include <optional>
#include <string>
#include <vector>

#include "scenario_findings.h"
#include "yaml/yaml_tree.h"

namespace rehearse {

/// `pass_rate`: the share of cases that pass, in the population from which the cases are drawn.
struct PassRateClaim {
  double at_least = 1.0;     // above 0 and below 1
  double confidence = 0.95;  // of the interval that decides, two-sided
};

/// An entry of `sometimes`: a state that some case must reach.
struct SometimesClaim {
  std::string name;
  Expectation condition;  // eventually
};

/// `plan`: how the values of the cases are drawn.
enum class PlanKind {
  random,           // independently
  sobol,            // from Sobol's sequence
  latin_hypercube,  // each parameter once from each of as many parts as there are cases
};

struct CampaignClaims {
  PlanKind plan = PlanKind::random;
  std::optional<PassRateClaim> pass_rate;
  std::vector<SometimesClaim> sometimes;  // in the order of the file
};

/// Reads the keys of a scenario's map. After the bodies and the duration.
CampaignClaims read_claims(Findings& findings, const YamlNode& root, const Scenario& scenario);

/// The claims of a scenario that was loaded.
CampaignClaims claims_of(const Scenario& scenario);

}  // namespace rehearse
