// The true values of a sensor that controllers read with errors.
#include <sstream>
#include <string>
#include <vector>

#include "kind.h"
#include "rows.h"

namespace rehearse {
namespace {

/// The names in the channel's metadata under `elements`, separated by blanks.
std::vector<std::string> elements_of_truth(const TraceChannel& channel) {
  std::vector<std::string> names;
  const auto found = channel.metadata.find("elements");
  if (found == channel.metadata.end()) return names;
  std::istringstream words(found->second);
  for (std::string word; words >> word;) names.push_back(word);
  return names;
}

}  // namespace

const ChannelForm truth_kind{
    .level = ChannelForm::Level::owner,
    .segment = "truth",
    .type = msg::DeviceState::type_name,
    .schema = msg::schema_text<msg::DeviceState>,
    .stage = Stage::sensors,
    .is_state = true,
    .make_rows =
        [](TraceChannel& channel, const std::string&) {
          return rows_of<msg::DeviceState>(
              channel, [names = elements_of_truth(channel)](msg::DeviceState& state, RowWriter& row) {
                for (std::size_t i = 0; i < state.values.size(); ++i)
                  row.put(i < names.size() ? names[i] : "values/" + std::to_string(i), state.values[i]);
              });
        },
    .has_rows_by_topic = true};

}  // namespace rehearse
