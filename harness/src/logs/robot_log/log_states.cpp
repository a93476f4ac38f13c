#include "log_states.h"

#include <fmt/format.h>

#include <utility>

#include "message_reader.h"

namespace rehearse {

Result<void> LogStates::take(std::int64_t time, mcap::Bytes payload) {
  const std::vector<double>* numbers = reader_.read(payload);
  if (!numbers) return misfit(payload);
  if (numbers->size() != source_.names.size())
    return error(fmt::format("{} numbers, where the map has {} names", numbers->size(), source_.names.size()),
                 "expected names: a name, or ~, for each number");
  samples_.push_back({time, *numbers});
  return {};
}

std::optional<std::map<std::string, double>> LogStates::in(std::int64_t from, std::int64_t until) {
  while (!samples_.empty() && samples_.front().time < from) samples_.pop_front();
  if (samples_.empty() || samples_.front().time >= until) return std::nullopt;
  if (samples_.size() > 1 && samples_[1].time < until) return std::nullopt;
  std::map<std::string, double> state;
  for (std::size_t i = 0; i < source_.names.size(); ++i)
    if (source_.names[i]) state[*source_.names[i]] = samples_.front().numbers[i];
  return state;
}

}  // namespace rehearse
