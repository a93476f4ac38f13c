#include "text_bundle.h"

#include <charconv>
#include <system_error>

namespace rehearse {
namespace {

constexpr std::string_view part_mark = "--- # rehearse file ";  // then the size, a blank, the key, the end of the line

}  // namespace

std::vector<std::pair<std::string, std::string>> parts_of_bundle(std::string_view text) {
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

void append_part(std::string& bundle, const std::string& key, const std::string& text) {
  if (!bundle.ends_with('\n')) bundle += '\n';
  bundle += std::string(part_mark) + std::to_string(text.size()) + " " + key + "\n" + text;
  bundle += '\n';
}

}  // namespace rehearse
