// A report read back, by the rules of tools/report/FORMAT.md and without the code that wrote it.
#pragma once

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "support/files.h"

namespace rehearse::testing {

using Json = nlohmann::json;

using test::read_file;

/// An empty page for reports, so that tests don't need npm.
inline std::filesystem::path plain_page(const std::filesystem::path& file) {
  std::ofstream(file) << "<!DOCTYPE html>\n<html><body><!-- REHEARSE DATA --></body></html>\n";
  return file;
}

class DecodedReport {
 public:
  explicit DecodedReport(const std::filesystem::path& file) : text_(read_file(file)) {
    std::size_t at = 0;
    while ((at = text_.find("<script ", at)) != std::string::npos) {
      const std::size_t id = text_.find("id=\"", at) + 4, tag_end = text_.find('>', at);
      const std::string name = text_.substr(id, text_.find('"', id) - id);
      const std::size_t end = text_.find("</script>", tag_end);
      elements_[name] = std::string_view(text_).substr(tag_end + 1, end - tag_end - 1);
      at = end;
    }
    object_ = Json::parse(elements_["report"], nullptr, false);
    EXPECT_FALSE(object_.is_discarded());
  }

  const std::string& text() const { return text_; }
  const Json& object() const { return object_; }
  const Json& operator[](const char* key) const { return object_.at(key); }

  /// The series of that name; null if there is none.
  const Json& series(const std::string& name) const {
    static const Json none;
    for (const Json& series : object_.at("series"))
      if (series.at("name") == name) return series;
    return none;
  }

  /// A blob's bytes, decoded.
  std::vector<std::uint8_t> bytes(const Json& blob) const {
    const std::vector<std::uint8_t> coded = from_base64(elements_.at(blob.at("id").get<std::string>()));
    if (blob.at("coding") == "none") return coded;
    std::vector<std::uint8_t> decoded(blob.at("bytes").get<std::size_t>());
    const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
        libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
    EXPECT_EQ(libdeflate_zlib_decompress(decompressor.get(), coded.data(), coded.size(), decoded.data(), decoded.size(),
                                         nullptr),
              LIBDEFLATE_SUCCESS);
    return decoded;
  }

  /// The bytes of an array of numbers; `base`: those of the series' values.
  std::vector<std::uint8_t> numbers(const Json& array, const std::vector<std::uint8_t>& base = {}) const {
    const std::string type = array.at("type");
    const std::size_t count = array.at("count"), size = type.ends_with("64") ? 8 : type.ends_with("32") ? 4 : 1;
    if (array.contains("constant")) return repeated(type, array.at("constant"), count);
    const std::vector<std::uint8_t> from = bytes(array);
    const std::size_t all = from.size() / size;
    EXPECT_GE(all, count);
    const std::string filter = array.at("filter");
    std::vector<std::uint8_t> to(from.size());
    for (std::size_t i = 0; i < all; ++i) {
      for (std::size_t byte = 0; byte < size; ++byte) {
        std::uint8_t value = filter == "none" ? from[i * size + byte] : from[byte * all + i];
        if (filter == "xor" && i > 0) value ^= to[(i - 1) * size + byte];
        if (filter == "xor-base") value ^= base.at(i * size + byte);
        to[i * size + byte] = value;
      }
    }
    to.resize(count * size);
    return to;
  }

  /// The 64 bits of each element.
  static std::vector<std::uint64_t> bits(const std::vector<std::uint8_t>& numbers, const std::string& type) {
    std::vector<std::uint64_t> all;
    if (type == "u8") {
      all.assign(numbers.begin(), numbers.end());
    } else {
      all.resize(numbers.size() / sizeof(std::uint64_t));
      if (!all.empty()) std::memcpy(all.data(), numbers.data(), numbers.size());
    }
    return all;
  }
  std::vector<std::uint64_t> values(const Json& series) const {
    return bits(numbers(series.at("values")), series.at("values").at("type"));
  }
  std::vector<std::uint64_t> golden(const Json& series) const {
    if (series.at("golden") == "same") return values(series);
    const auto base = series.at("values").is_null() ? std::vector<std::uint8_t>() : numbers(series.at("values"));
    return bits(numbers(series.at("golden"), base), series.at("golden").at("type"));
  }

  std::vector<std::int64_t> ticks(const Json& axis_index) const {
    const Json& axis = object_.at("axes").at(axis_index.get<std::size_t>());
    std::vector<std::int64_t> ticks;
    if (axis.contains("count")) {
      for (std::int64_t i = 0; i < axis.at("count"); ++i) ticks.push_back(axis.at("begin").get<std::int64_t>() + i);
      return ticks;
    }
    const auto bytes_of_all = numbers(axis.at("ticks"));
    for (std::size_t i = 0; i + 4 <= bytes_of_all.size(); i += 4) {
      std::uint32_t tick = 0;
      std::memcpy(&tick, &bytes_of_all[i], 4);
      ticks.push_back(tick);
    }
    return ticks;
  }

 private:
  static std::vector<std::uint8_t> from_base64(std::string_view text) {
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::uint8_t> bytes;
    std::uint32_t bits = 0;
    int held = 0;
    EXPECT_EQ(text.size() % 4, 0u);
    for (const char letter : text) {
      if (letter == '=') break;
      const std::size_t value = letters.find(letter);
      EXPECT_NE(value, std::string_view::npos);
      bits = bits << 6 | static_cast<std::uint32_t>(value);
      held += 6;
      if (held < 8) continue;
      held -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> held));
    }
    return bytes;
  }

  template <class T>
  static std::vector<std::uint8_t> copies(T value, std::size_t count) {
    std::vector<std::uint8_t> bytes(count * sizeof(T));
    for (std::size_t i = 0; i < count; ++i) std::memcpy(&bytes[i * sizeof(T)], &value, sizeof(T));
    return bytes;
  }
  static double number(const Json& json) {
    if (json.is_number()) return json.get<double>();
    const std::string word = json;
    if (word == "NaN") return std::numeric_limits<double>::quiet_NaN();
    return word == "Infinity" ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
  }
  static std::vector<std::uint8_t> repeated(const std::string& type, const Json& constant, std::size_t count) {
    if (type == "f64") return copies(number(constant), count);
    if (type == "f32") return copies(static_cast<float>(number(constant)), count);
    if (type == "i64")
      return copies(constant.is_string() ? std::stoll(constant.get<std::string>()) : constant.get<std::int64_t>(),
                    count);
    if (type == "u64")
      return copies(constant.is_string() ? std::stoull(constant.get<std::string>()) : constant.get<std::uint64_t>(),
                    count);
    if (type == "u32") return copies(constant.get<std::uint32_t>(), count);
    return copies(constant.get<std::uint8_t>(), count);
  }

  std::string text_;
  std::map<std::string, std::string_view> elements_;
  Json object_;
};

}  // namespace rehearse::testing
