// VariableRecorder: records the variables that controllers set by rehearse_variable() as messages of a trace.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/variables.h"
#include "trace_output.h"

namespace rehearse {

/// The recorder of one controller's variables.
class VariableRecorder {
 public:
  /// Writes a message for each variable that was set in this tick. Its channel is added with the first message.
  Result<void> write(TraceOutput& output, std::int64_t tick, const std::string& controller_label,
                     const ControllerVariables& variables);

 private:
  std::vector<std::uint16_t> channels_;  // channel of each variable; 0: none yet
};

}  // namespace rehearse
