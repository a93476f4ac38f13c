// What the decoders of all encodings share. Internal.
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "ros2msg.h"

namespace rehearse::ros2msg {

/// One pass over one payload: the path of the present value, and the first problem.
class PayloadWalk {
 public:
  bool ok() const { return problem_.empty(); }
  std::string take_problem() { return std::move(problem_); }

 protected:
  PayloadWalk(const Schema& schema, std::string& path, Visitor& visitor)
      : schema_(schema), path_(path), visitor_(visitor) {}

  /// Extends the path during its lifetime.
  class Segment {
   public:
    Segment(std::string& path, std::string_view name) : path_(path), length_(path.size()) {
      if (!path_.empty()) path_ += '/';
      path_ += name;
    }
    ~Segment() { path_.resize(length_); }
    Segment(const Segment&) = delete;
    Segment& operator=(const Segment&) = delete;

   private:
    std::string& path_;
    std::size_t length_;
  };

  /// Calls `element` for each number of an element, with the path of that element.
  template <class Element>
  void array(std::uint32_t count, const Element& element) {
    visitor_.begin_array(count);
    std::array<char, 16> digits;
    for (std::uint32_t i = 0; i < count && ok(); ++i) {
      const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), i).ptr;
      const Segment segment(path_, std::string_view(digits.data(), end));
      element(i);
    }
    if (ok()) visitor_.end_array();
  }

  static void set_signed(Value& value, std::int64_t number) {
    value.kind = Value::Kind::signed_integer;
    value.integer = number;
  }
  static void set_unsigned(Value& value, std::uint64_t number, Value::Kind kind = Value::Kind::unsigned_integer) {
    value.kind = kind;
    value.unsigned_integer = number;
  }
  static void set_text(Value& value, std::string_view text) {
    value.kind = Value::Kind::text;
    value.text = text;
  }
  static void set_blob(Value& value, std::span<const std::byte> blob) {
    value.kind = Value::Kind::blob;
    value.blob = blob;
  }

  void emit(Value& value) {
    if (!ok()) return;
    value.path = path_;
    visitor_.value(value);
  }
  void fail(std::string problem) {
    if (ok()) problem_ = std::move(problem);
  }

  const Schema& schema_;
  std::string& path_;
  Visitor& visitor_;
  std::string problem_;
};

/// Decodes a payload of that encoding. The result is Decoder::problem().
std::string walk_json(const Schema& schema, std::span<const std::byte> payload, std::string& path, Visitor& visitor);
std::string walk_protobuf(const Schema& schema, std::span<const std::byte> payload, std::string& path,
                          Visitor& visitor);

}  // namespace rehearse::ros2msg
