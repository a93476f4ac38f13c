#include "variable_recorder.h"

#include "trace/float64_message.h"

namespace rehearse {

Result<void> VariableRecorder::write(TraceOutput& output, std::int64_t tick, const std::string& controller_label,
                                     const ControllerVariables& variables) {
  channels_.resize(variables.all().size(), 0);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const ControllerVariables::Variable& variable = variables.all()[i];
    if (!variable.is_set) continue;
    if (!channels_[i])
      channels_[i] = output.channel<msg::Float64>(ChannelName::of_variable(controller_label, variable.name));
    if (auto done = output.write(channels_[i], tick, msg::Float64{variable.value}); !done) return done;
  }
  return {};
}

}  // namespace rehearse
