#include "text_bundle.h"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace rehearse {
namespace {

constexpr std::string_view part_mark = "--- # rehearse file ";  // then the size, a blank, the key, the end of the line

/// The parts of a bundle by key, in order, the main text first under ""; nothing if the text is no bundle.
std::vector<std::pair<std::string, std::string>> parts_of(std::string_view text) {
  std::vector<std::pair<std::string, std::string>> parts;
  std::size_t at = text.find("\n" + std::string(part_mark));
  if (at == std::string_view::npos) return parts;
  parts.emplace_back("", text.substr(0, at + 1));
  for (++at; at < text.size() && text.substr(at).starts_with(part_mark);) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string_view::npos) break;
    const std::string_view head = text.substr(at + part_mark.size(), end - at - part_mark.size());
    std::size_t size = 0;
    const auto [rest, bad] = std::from_chars(head.data(), head.data() + head.size(), size);
    if (bad != std::errc() || rest == head.data() + head.size() || size > text.size() - end - 1) break;
    parts.emplace_back(std::string(rest + 1, head.data() + head.size()), text.substr(end + 1, size));
    at = end + 1 + size + 1;
  }
  return parts;
}

}  // namespace

TextBundle::TextBundle(const std::string& text) {
  for (auto& [key, part] : parts_of(text)) texts_[key] = std::move(part);
  is_of_recording_ = !texts_.empty();
  if (!is_of_recording_) texts_[""] = text;
}

const std::string* TextBundle::find(const std::string& key) const {
  const auto found = texts_.find(key);
  return found == texts_.end() ? nullptr : &found->second;
}

void TextBundle::keep(const std::string& key) {
  if (!keeps(key)) kept_.push_back(key);
}

bool TextBundle::keeps(const std::string& key) const { return std::ranges::find(kept_, key) != kept_.end(); }

std::string TextBundle::text() const {
  std::string all = main();
  for (const std::string& key : kept_) {
    const std::string& part = texts_.at(key);
    if (!all.ends_with('\n')) all += '\n';
    all += std::string(part_mark) + std::to_string(part.size()) + " " + key + "\n" + part + "\n";
  }
  return all;
}

}  // namespace rehearse
