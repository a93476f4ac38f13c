#include "message_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

#include "base/text.h"

namespace rehearse {

namespace {

void append_escaped(std::string& json, char c) {
  switch (c) {
    case '"': json += "\\\""; break;
    case '\\': json += "\\\\"; break;
    case '\n': json += "\\n"; break;
    case '\r': json += "\\r"; break;
    case '\t': json += "\\t"; break;
    default: fmt::format_to(std::back_inserter(json), "\\u{:04x}", static_cast<unsigned>(static_cast<std::uint8_t>(c)));
  }
}

template <class Integer>
void append_integer(std::string& json, Integer number) {
  std::array<char, 24> digits;
  json.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
}

}  // namespace

void append_json(std::string& json, std::string_view text) {
  json += '"';
  while (!text.empty()) {
    const char c = text.front();
    const std::size_t length = utf8_length(text);
    if (length == 0) {
      json += "\xef\xbf\xbd";
    } else if (length == 1 && (static_cast<std::uint8_t>(c) < 0x20 || c == '"' || c == '\\' || c == 0x7f)) {
      append_escaped(json, c);
    } else {
      json += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  json += '"';
}

void append_json(std::string& json, double number) {
  if (std::isnan(number)) {
    json += "\"NaN\"";
  } else if (std::isinf(number)) {
    json += number > 0.0 ? "\"Infinity\"" : "\"-Infinity\"";
  } else {
    std::array<char, 32> digits;
    const std::string_view text(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
    json += text;
    if (text.find_first_of(".e") == std::string_view::npos) json += ".0";
  }
}

void append_base64(std::string& text, std::span<const std::byte> bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto number = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  const std::size_t begin = text.size();
  text.resize(begin + (bytes.size() + 2) / 3 * 4);
  char* to = text.data() + begin;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = number(i) << 16;
    if (left > 1) bits |= number(i + 1) << 8;
    if (left > 2) bits |= number(i + 2);
    *to++ = letters[bits >> 18];
    *to++ = letters[bits >> 12 & 63];
    *to++ = left > 1 ? letters[bits >> 6 & 63] : '=';
    *to++ = left > 2 ? letters[bits & 63] : '=';
  }
}

namespace ros2msg {

namespace {

/// The common parts of JSON and lines for people: commas, and a limit of the size.
class TextVisitor : public Visitor {
 public:
  TextVisitor(std::size_t max_size, std::string_view separator) : max_size_(max_size), separator_(separator) {}

  bool is_too_long() const { return too_long_; }
  std::string take_text() { return std::move(text_); }

 protected:
  /// False if the limit is reached.
  bool begin_element() {
    if (text_.size() > max_size_) too_long_ = true;
    if (too_long_) return false;
    if (needs_separator_) text_ += separator_;
    needs_separator_ = true;
    return true;
  }
  void open(char bracket) {
    text_ += bracket;
    needs_separator_ = false;
  }
  void close(char bracket) {
    text_ += bracket;
    needs_separator_ = true;
  }
  void append_value(const Value& value) {
    using Kind = Value::Kind;
    switch (value.kind) {
      case Kind::signed_integer: append_integer(text_, value.integer); break;
      case Kind::unsigned_integer: append_integer(text_, value.unsigned_integer); break;
      case Kind::floating: append_json(text_, value.number); break;
      case Kind::boolean: text_ += value.unsigned_integer != 0 ? "true" : "false"; break;
      case Kind::text: append_json(text_, value.text); break;
      case Kind::blob:
        text_ += '"';
        append_base64(text_, value.blob);
        text_ += '"';
        break;
    }
  }

  std::string text_;
  bool needs_separator_ = false;

 private:
  const std::size_t max_size_;
  const std::string_view separator_;
  bool too_long_ = false;
};

/// A field's value follows its name, so the value begins no new element: `after_name_`.
class JsonVisitor final : public TextVisitor {
 public:
  explicit JsonVisitor(std::size_t max_size) : TextVisitor(max_size, ",") {}

  void begin_message() override {
    if (begin_value()) open('{');
  }
  void end_message() override { close('}'); }
  void field(std::string_view name) override {
    if (!begin_element()) return;
    append_json(text_, name);
    text_ += ':';
    after_name_ = true;
  }
  void begin_array(std::uint32_t) override {
    if (begin_value()) open('[');
  }
  void end_array() override { close(']'); }
  void value(const Value& value) override {
    if (begin_value()) append_value(value);
  }

 private:
  bool begin_value() {
    if (after_name_) return after_name_ = false, true;
    return begin_element();
  }
  bool after_name_ = false;
};

/// After the first few elements of an array it prints nothing until that array ends.
class LineVisitor final : public TextVisitor {
 public:
  LineVisitor() : TextVisitor(std::size_t{1} << 20, " ") {}

  void begin_message() override {
    if (depth_++ == 0) return;  // the whole message: no brackets
    if (begin_value()) open('{');
  }
  void end_message() override {
    if (--depth_ > 0 && !is_silent()) close('}');
  }
  void field(std::string_view name) override {
    if (is_silent() || !begin_element()) return;
    text_ += name;
    text_ += '=';
    after_name_ = true;
  }
  void begin_array(std::uint32_t count) override {
    if (begin_value()) open('[');
    arrays_.push_back({count, 0, is_silent()});
  }
  void end_array() override {
    const Array array = arrays_.back();
    arrays_.pop_back();
    if (array.was_silent) return;
    if (silent_from_ > arrays_.size()) silent_from_ = nowhere;
    if (array.count > shown) text_ += fmt::format(" ... {} in all", array.count);
    close(']');
  }
  void value(const Value& value) override {
    if (!begin_value()) return;
    if (value.kind == Value::Kind::blob) {
      text_ += fmt::format("({} bytes)", value.blob.size());
    } else {
      append_value(value);
    }
  }

 private:
  static constexpr std::uint32_t shown = 8;
  static constexpr std::size_t nowhere = static_cast<std::size_t>(-1);
  struct Array {
    std::uint32_t count = 0;
    std::uint32_t begun = 0;
    bool was_silent = false;
  };

  bool is_silent() const { return silent_from_ <= arrays_.size(); }
  bool begin_value() {
    if (after_name_) return after_name_ = false, true;
    if (is_silent()) return false;
    if (!arrays_.empty() && ++arrays_.back().begun > shown) {
      silent_from_ = arrays_.size();
      return false;
    }
    return begin_element();
  }

  std::vector<Array> arrays_;  // open arrays
  // Number of open arrays when the innermost one reached the limit of shown elements.
  std::size_t silent_from_ = nowhere;
  int depth_ = 0;
  bool after_name_ = false;
};

template <class V>
Result<std::string> to_text(Decoder& decoder, std::span<const std::byte> payload, V visitor) {
  if (!decoder.decode(payload, visitor)) return error(fmt::format("the payload {}", decoder.problem()));
  if (visitor.is_too_long()) return error("the message is too long as text");
  return visitor.take_text();
}

}  // namespace

Result<std::string> to_json(Decoder& decoder, std::span<const std::byte> payload, std::size_t max_size) {
  return to_text(decoder, payload, JsonVisitor(max_size));
}

Result<std::string> to_line(Decoder& decoder, std::span<const std::byte> payload) {
  return to_text(decoder, payload, LineVisitor());
}

}  // namespace ros2msg

}  // namespace rehearse
