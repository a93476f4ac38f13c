// For any text, the schema parser returns a schema or errors with a line, and never crashes, hangs or recurses without
// end. A valid schema decodes any bytes without a crash.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string_view>
#include <vector>

#include "core/ros2msg/ros2msg.h"

using namespace rehearse;

namespace {

/// Every index leads somewhere, and no type leads back to itself.
void check(const ros2msg::Schema& schema) {
  if (schema.definitions.empty()) std::abort();
  std::vector<int> depth(schema.definitions.size(), 0);  // nesting of each definition; 0: not known yet
  const std::function<int(std::size_t, int)> visit = [&](std::size_t at, int above) {
    if (above > 1000) std::abort();
    if (depth[at] != 0) return depth[at];
    int below = 0;
    for (const auto& field : schema.definitions[at].fields) {
      if (field.name.empty()) std::abort();
      if (!field.type.is_message) continue;
      if (field.type.message >= schema.definitions.size()) std::abort();
      below = std::max(below, visit(field.type.message, above + 1));
    }
    return depth[at] = below + 1;
  };
  for (std::size_t i = 0; i < schema.definitions.size(); ++i) visit(i, 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  auto parsed = ros2msg::Schema::parse("fuzz_msgs/msg/Fuzz", text, "fuzz");
  if (!parsed) {
    for (const Diagnostic& diagnostic : parsed.errors()) {
      if (diagnostic.message.empty() || diagnostic.line < 0) std::abort();
    }
    return 0;
  }
  check(*parsed);
  ros2msg::Decoder decoder(std::move(*parsed));
  std::uint64_t sum = 0;
  const auto touch = [&](const ros2msg::Value& value) {
    sum += value.path.size() + value.text.size() + value.blob.size();
  };
  for (const std::uint8_t filling : {0x00, 0x01, 0xff}) {
    std::vector<std::byte> payload(4096, std::byte{filling});
    payload[0] = payload[2] = payload[3] = std::byte{0};
    payload[1] = std::byte{1};
    decoder.decode(payload, touch);
    payload[1] = std::byte{0};
    decoder.decode(payload, touch);
  }
  return 0;
}
