#include "tap_definitions.h"

#include <fmt/format.h>
#include <rehearse/tap.h>
#include <rehearse/tap_ring.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <set>

#include "base/text.h"

namespace rehearse {
namespace {

constexpr std::size_t most_series = 256, most_numbers = tap_most_record_words / 2;

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

bool is_name(std::string_view word) {
  return !word.empty() && word.size() <= 200 &&
         std::ranges::none_of(word, [](char one) { return static_cast<unsigned char>(one) < ' ' || one == 127; });
}

/// A series of one of the four kinds; nullopt: the words are none.
std::optional<TapSeries> series_of(const std::vector<std::string_view>& words) {
  TapSeries series;
  if (words.size() < 4 || !is_name(words[1]) || words[1].find('/') != std::string_view::npos) return std::nullopt;
  series.body = words[1];
  if (words[0] == "imu" || words[0] == "device") {
    series.kind = words[0] == "imu" ? TapSeries::Kind::imu : TapSeries::Kind::device;
    const auto numbers = number_in<std::size_t>(std::string(words[3]));
    if (words.size() != 4 || !is_name(words[2]) || !numbers) return std::nullopt;
    if (series.kind == TapSeries::Kind::imu && *numbers != 6) return std::nullopt;
    series.device = words[2];
    series.numbers = *numbers;
  } else if (words[0] == "joints" || words[0] == "commands") {
    series.kind = words[0] == "joints" ? TapSeries::Kind::joints : TapSeries::Kind::commands;
    const auto quantities = number_in<int>(std::string(words[2]));
    if (!quantities || *quantities < 1 || *quantities > 7) return std::nullopt;
    series.quantities = *quantities;
    for (const std::string_view name : std::span(words).subspan(3)) {
      if (!is_name(name)) return std::nullopt;
      series.names.emplace_back(name);
    }
    series.numbers = series.names.size() * static_cast<std::size_t>(std::popcount(static_cast<unsigned>(*quantities)));
  } else {
    return std::nullopt;
  }
  if (series.numbers == 0 || series.numbers > most_numbers) return std::nullopt;
  return series;
}

/// The quantities of joints and the devices of a series, each with the series' kind.
std::vector<std::string> owned_by(const TapSeries& series) {
  std::vector<std::string> all;
  if (!series.is_of_joints()) return {"device " + series.device};
  const char* side = series.kind == TapSeries::Kind::joints ? "input" : "command";
  for (const std::string& name : series.names)
    for (int bit = REHEARSE_TAP_Q; bit <= REHEARSE_TAP_U; bit *= 2)
      if (series.quantities & bit) all.push_back(fmt::format("{} {} of joint {}", side, bit, name));
  return all;
}

}  // namespace

Result<TapDefinitions> TapDefinitions::parse(std::string_view text) {
  TapDefinitions definitions;
  std::set<std::string> owned;
  if (!text.empty() && text.back() == '\n') text.remove_suffix(1);
  if (text.empty()) return definitions;
  for (const std::string_view line : split(text, '\n')) {
    const std::vector<std::string_view> words = split(line, '\t');
    if ((words[0] == "parameter" || words[0] == "machine") && words.size() == 3 && is_name(words[1])) {
      mcap::StringMap& facts = words[0] == "machine" ? definitions.machine : definitions.parameters;
      facts.insert_or_assign(std::string(words[1]), std::string(words[2]));
      continue;
    }
    auto series = series_of(words);
    if (!series || definitions.series.size() == most_series)
      return error(fmt::format("a series of the tap can't be read: {}", in_quotes(printable(line, 80))));
    if (!definitions.series.empty() && definitions.series[0].body != series->body)
      return error(fmt::format("the series of a tap are of one body, and these of '{}' and '{}'",
                               definitions.series[0].body, series->body),
                   "open a tap for each body");
    for (std::string& one : owned_by(*series))
      if (!owned.insert(one).second) return error(fmt::format("two series have the {}", one));
    definitions.series.push_back(*std::move(series));
  }
  return definitions;
}

namespace {

/// Takes bytes off the begin of the words: their count, then as many words as they need. nullopt: there are none.
std::optional<std::string_view> take_bytes(std::span<const std::uint64_t>& words) {
  if (words.empty() || words[0] > 8 * (words.size() - 1)) return std::nullopt;
  const std::string_view bytes(reinterpret_cast<const char*>(words.data() + 1), words[0]);
  words = words.subspan(1 + (words[0] + 7) / 8);
  return bytes;
}

/// All of the words are bytes.
std::optional<std::string_view> bytes_in(std::span<const std::uint64_t> words) {
  const auto bytes = take_bytes(words);
  return words.empty() ? bytes : std::nullopt;
}

}  // namespace

bool TapTick::read(std::span<const std::uint64_t> record, const TapDefinitions& definitions) {
  entries.clear();
  if (record.size() < tap_record_head_words) return false;
  numbers_.resize(record.size());
  std::memcpy(numbers_.data(), record.data(), record.size_bytes());
  tick = static_cast<std::int64_t>(record[1]);
  loop_time = static_cast<std::int64_t>(record[3]);
  if (tick < 0 || record[0] >> 32 != 0) return false;
  for (std::size_t at = tap_record_head_words; at < record.size();) {
    const std::uint64_t head = record[at++];
    const std::size_t count = head & UINT32_MAX;
    TapEntry entry{static_cast<unsigned>(head >> 56), head >> 32 & 0xFFFFFF};
    if (count > record.size() - at) return false;
    std::span<const std::uint64_t> words = record.subspan(at, count);
    const std::span<const double> numbers = std::span(numbers_).subspan(at, count);
    at += count;
    std::optional<std::string_view> text;
    switch (entry.kind) {
      case tap_values:
        if (entry.series >= definitions.series.size() || count != definitions.series[entry.series].numbers)
          return false;
        entry.numbers = numbers;
        break;
      case tap_absent:
        if (entry.series >= definitions.series.size() || count != 0) return false;
        break;
      case tap_variable:
        if (words.empty() || !(text = bytes_in(words.subspan(1))) || text->empty()) return false;
        entry.numbers = numbers.first(1);
        break;
      case tap_text:
      case tap_mark:
        if (!(text = bytes_in(words))) return false;
        break;
      case tap_image:
        text = take_bytes(words);
        if (!text || text->empty()) return false;
        entry.device = *text;
        if (!(text = bytes_in(words))) return false;
        break;
      default: return false;
    }
    entry.text = text.value_or(std::string_view());
    entries.push_back(entry);
  }
  return true;
}

}  // namespace rehearse
