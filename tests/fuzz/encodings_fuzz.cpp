// For any definition in an encoding other than ros2msg, the parser returns a schema or errors; a schema that was read
// decodes any payload without a crash. Input: a byte that selects the encoding, the length of the definition in two
// bytes (low byte first), the definition, the payload.

#include <rehearse/mcap.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>

#include "core/ros2msg/message_format.h"

using namespace rehearse;

namespace {

struct Encodings {
  const char *message, *schema, *type;
};
constexpr std::array<Encodings, 4> encodings{{{"cdr", "ros2idl", "p/msg/T"},
                                              {"ros1", "ros1msg", "p/T"},
                                              {"json", "jsonschema", "T"},
                                              {"protobuf", "protobuf", "p.T"}}};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t head = 3;
  if (size < head) return 0;
  const Encodings& chosen = encodings[data[0] % encodings.size()];
  const std::size_t length = std::min<std::size_t>(data[1] + 256u * data[2], size - head);
  mcap::Schema schema;
  schema.name = chosen.type;
  schema.encoding = chosen.schema;
  schema.data.assign(reinterpret_cast<const char*>(data) + head, length);
  auto parsed = ros2msg::schema_of(chosen.message, schema, "fuzz");
  if (!parsed) {
    for (const Diagnostic& diagnostic : parsed.errors())
      if (diagnostic.message.empty()) std::abort();
    return 0;
  }
  ros2msg::Decoder decoder(*std::move(parsed));
  const auto* payload = reinterpret_cast<const std::byte*>(data) + head + length;
  std::uint64_t sum = 0;
  decoder.decode({payload, size - head - length}, [&](const ros2msg::Value& value) {
    sum += value.path.size() + value.text.size() + value.blob.size();
  });
  return 0;
}
