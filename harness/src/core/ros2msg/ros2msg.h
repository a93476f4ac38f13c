// ros2msg: the schema language of ROS 2 messages, and a decoder for any payload that such a schema describes. Schemas
// in other languages, and payloads in other encodings, are in message_format.h.
//
// A schema text is the fields of a type, then for each type that it uses a line of '=' signs, a line "MSG:
// package/Name" and its fields. A field is `TYPE name` with an optional default, a constant is `TYPE NAME=value`. TYPE
// is a primitive or a message type, followed by `[]`, `[n]` or `[<=n]` for a sequence, an array or a bounded sequence;
// `string<=n` is a bounded string. Defaults and constants must be values of their type.
//
// Some writers leave out well-known types: builtin_interfaces/Time and Duration and std_msgs/Header need no definition.
// wstring is refused: middlewares encode it differently, and the payload doesn't state the encoding.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::ros2msg {

enum class Primitive { boolean, int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64, string };

struct FieldType {
  enum class Shape { single, array, sequence };
  bool is_message = false;
  Primitive primitive = Primitive::boolean;  // the type, unless it is a message; `byte` and `char` are uint8
  std::size_t message = 0;                   // index into Schema::definitions, if the type is a message
  Shape shape = Shape::single;
  std::uint32_t count = 0;         // array: its length. sequence: at most this many, 0 for no bound
  std::uint32_t string_bound = 0;  // at most this many bytes, 0 for no bound
};

struct FieldDefinition {
  std::string name;
  FieldType type;
  std::string default_value;       // as written; empty if there is none
  std::string stored_as = {};      // JSON: the name in payloads; empty: `name`
  std::uint32_t number = 0;        // protobuf: in payloads
  std::uint8_t protobuf_type = 0;  // protobuf: a ProtobufType
};

struct Constant {
  std::string name;
  Primitive type = Primitive::boolean;
  std::string value;  // as written, a string without its quotes
};

struct Definition {
  std::string name;  // as sensor_msgs/JointState
  std::vector<FieldDefinition> fields;
  std::vector<Constant> constants;
};

/// The encoding of payloads.
enum class Encoding { cdr, ros1, json, protobuf };

/// A parsed schema. The first definition is the type itself.
struct Schema {
  std::vector<Definition> definitions;
  Encoding encoding = Encoding::cdr;

  /// `type` is the schema's name (sensor_msgs/msg/JointState); `file` is the name of the text in messages. Errors have
  /// the line: unknown and cyclic types, malformed lines, duplicate names.
  static Result<Schema> parse(std::string_view type, std::string_view text, std::string file = {});
};

/// One value of a payload. Elements of arrays are delivered one by one, except arrays of uint8, which are one blob.
struct Value {
  enum class Kind { signed_integer, unsigned_integer, floating, boolean, text, blob };
  std::string_view path;  // names and element numbers with / between them: transforms/0/header/frame_id
  Kind kind = Kind::floating;
  std::int64_t integer = 0;            // signed_integer
  std::uint64_t unsigned_integer = 0;  // unsigned_integer; boolean: 0 or 1
  double number = 0.0;                 // floating: exact, a float32 widened
  std::string_view text;               // text, in the payload
  std::span<const std::byte> blob;     // blob, in the payload
  std::span<const std::byte> bytes;    // the bytes of a number in a payload of CDR or ROS 1

  bool is_number() const { return kind != Kind::text && kind != Kind::blob; }
};

/// Receives the contents of a payload in its order. Between begin_message() and end_message() each field is announced
/// by field(); it is followed by a value, a message, or an array of either.
class Visitor {
 public:
  virtual ~Visitor() = default;
  virtual void begin_message() = 0;
  virtual void end_message() = 0;
  virtual void field(std::string_view name) = 0;
  virtual void begin_array(std::uint32_t count) = 0;
  virtual void end_array() = 0;
  virtual void value(const Value& value) = 0;
};

/// Decodes payloads of one schema. Two threads must not use it at a time.
class Decoder {
 public:
  explicit Decoder(Schema schema) : schema_(std::move(schema)) {}

  /// Calls `callback` for every value in the order of the schema. False if the payload ends too early, has another
  /// encoding, or violates a bound; the values before were delivered. Bytes left over at the end are ignored.
  bool decode(std::span<const std::byte> payload, const std::function<void(const Value&)>& callback);

  /// Calls `visitor` for every value and for the structure of the message. After an error, open messages and arrays are
  /// not ended.
  bool decode(std::span<const std::byte> payload, Visitor& visitor);

  /// The reason why the last decode() failed, as "ends at byte 12, within position/3"; empty if it succeeded.
  const std::string& problem() const { return problem_; }

 private:
  Schema schema_;
  std::string path_;  // path of the present value; a member, so that its memory is reused
  std::string problem_;
};

}  // namespace rehearse::ros2msg
