#include "schemas.h"

#include <iterator>
#include <utility>

#include "core/check/noise_floor.h"
#include "core/scenario/scenario_forms.h"
#include "log_verbs.h"

namespace rehearse::tool {

std::vector<NamedForm> all_schemas() {
  std::vector<NamedForm> all{{"scenario", "a scenario of Rehearse, also of a campaign", types::of(scenario_form)},
                             {"tolerances", "a file with tolerances alone", types::of(tolerances_file_form)},
                             {"noise", "the noise floor beside a golden", types::of(noise_file_form)}};
  for (auto objects :
       {forms_of_logs(), verdict_objects(), log_objects(), file_objects(), golden_objects(), campaign_objects()})
    all.insert(all.end(), std::make_move_iterator(objects.begin()), std::make_move_iterator(objects.end()));
  return all;
}

}  // namespace rehearse::tool
