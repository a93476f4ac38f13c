// The objects of golden and its parts.
#include <string>
#include <vector>

#include "json_forms.h"

namespace rehearse::tool {
namespace {

ValueType texts() { return types::array(types::string()); }
ValueType maybe_text() { return types::nullable(types::string()); }

const Form& golden_entry_form() {
  static const Form form{
      "golden_entry",
      "a golden",
      {member("name", types::string()), member("owners", texts()), member("bytes", types::count()),
       member("recorded_by", types::string()), member("accepted", maybe_text()), member("acceptances", types::count()),
       member("pending", types::flag()), member("orphan", types::flag()), member("problem", maybe_text()),
       member("notes", types::any())}};
  return form;
}

const Form& golden_list_form() {
  static const Form form = with_version(
      {"golden_list",
       "golden list --json",
       {member("folder", types::string()), member("goldens", types::array(types::of(golden_entry_form)))}});
  return form;
}

const Form& waiting_form() {
  static const Form form{"waiting",
                         "a run that waits",
                         {member("name", types::string()), member("golden", maybe_text()),
                          member("run", types::string()), member("verdict", types::string()), member("moved", texts()),
                          member("pictures", types::any()), member("problems", findings_type())}};
  return form;
}

const Form& golden_review_form() {
  static const Form form = with_version(
      {"golden_review", "golden review --json", {member("waiting", types::array(types::of(waiting_form)))}});
  return form;
}

const Form& refused_form() {
  static const Form form{
      "refused", "a golden that is refused", {member("name", types::string()), member("findings", findings_type())}};
  return form;
}

const Form& accepted_form() {
  static const Form form{"accepted",
                         "an accepted golden",
                         {member("name", types::string()), member("golden", types::string()),
                          member("digest", types::string()), member("changed", types::flag()),
                          member("whole", types::flag()), member("verdict", maybe_text()), member("moved", texts())}};
  return form;
}

const Form& golden_accept_form() {
  static const Form form = with_version({"golden_accept",
                                         "golden accept --json",
                                         {member("accepted", types::array(types::of(accepted_form))),
                                          member("refused", types::array(types::of(refused_form)))}});
  return form;
}

const Form& golden_reject_form() {
  static const Form form =
      with_version({"golden_reject",
                    "golden reject --json",
                    {member("rejected", texts()), member("refused", types::array(types::of(refused_form)))}});
  return form;
}

const Form& golden_prune_form() {
  static const Form form =
      with_version({"golden_prune",
                    "golden prune --json",
                    {member("orphans", types::any()), member("removed", texts()), member("moved", texts()),
                     member("folder", maybe_text()), member("problems", findings_type())}});
  return form;
}

const Form& perturbation_object_form() {
  static const Form form{
      "perturbation",
      "a perturbation",
      {member("name", types::string()), member("made", types::flag()), member("why_not", types::string()),
       member("within", types::flag()), member("beyond", difference_type()), member("closed", types::flag()),
       member("horizon", types::nullable(types::real()))}};
  return form;
}

const Form& channel_noise_object_form() {
  static const Form form{"channel_noise",
                         "the noise of a channel",
                         {member("channel", types::string()), member("unit", types::string()),
                          member("controller", types::nullable(types::real())),
                          member("plant", types::nullable(types::real())), member("tolerance", types::real())}};
  return form;
}

std::vector<FormKey> noise_members() {
  return {member("scenario", types::string()),
          member("duration", types::real()),
          member("horizon", types::nullable(types::real())),
          member("growth", types::nullable(types::real())),
          member("perturbations", types::array(types::of(perturbation_object_form))),
          member("channels", types::array(types::of(channel_noise_object_form))),
          member("file", maybe_text()),
          member("not_kept", types::any())};
}

const Form& measured_noise_form() {
  static const Form form{"measured_noise", "the noise of a scenario", noise_members()};
  return form;
}

const Form& golden_noise_form() {
  static const Form form = with_version({"golden_noise", "golden noise --json", noise_members()});
  return form;
}

const Form& golden_noises_form() {
  static const Form form = with_version({"golden_noises",
                                         "golden noise --json of several scenarios",
                                         {member("scenarios", types::array(types::of(measured_noise_form)))}});
  return form;
}

}  // namespace

std::vector<NamedForm> golden_objects() {
  return {object_of("golden-list", "golden list --json", {golden_list_form}),
          object_of("golden-review", "golden review --json", {golden_review_form}),
          object_of("golden-accept", "golden accept --json", {golden_accept_form}),
          object_of("golden-reject", "golden reject --json", {golden_reject_form}),
          object_of("golden-prune", "golden prune --json", {golden_prune_form}),
          object_of("golden-noise", "golden noise --json", {golden_noise_form, golden_noises_form})};
}

}  // namespace rehearse::tool
