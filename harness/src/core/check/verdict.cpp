#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/verdict.h>

#include <algorithm>
#include <utility>

namespace rehearse {

void Verdict::lead(VerdictCode code, std::string sentence) {
  parts_.insert(parts_.begin(), VerdictPart{code, std::move(sentence)});
}

void Verdict::add(VerdictCode code, std::string sentence) { parts_.push_back({code, std::move(sentence)}); }

void Verdict::add(const Verdict& others) { parts_.insert(parts_.end(), others.parts_.begin(), others.parts_.end()); }

std::string Verdict::text() const { return text_without({}); }

std::string Verdict::text_without(const std::vector<VerdictCode>& codes) const {
  std::vector<std::string_view> sentences;
  for (const VerdictPart& part : parts_)
    if (!part.sentence.empty() && std::ranges::find(codes, part.code) == codes.end())
      sentences.push_back(part.sentence);
  return fmt::format("{}", fmt::join(sentences, "; "));
}

std::vector<VerdictCode> Verdict::codes() const {
  std::vector<VerdictCode> codes;
  for (const VerdictPart& part : parts_) codes.push_back(part.code);
  return codes;
}

std::string Verdict::code() const { return parts_.empty() ? std::string() : std::string(to_string(parts_[0].code)); }

}  // namespace rehearse
