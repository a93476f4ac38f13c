#include <rehearse/units.h>

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <iterator>
#include <vector>

namespace rehearse {
namespace {

/// The spellings of the densities of all units, by row.
struct Densities {
  std::deque<std::string> texts;
  std::vector<Spelling> spellings[std::size(units::rows)][2];

  Densities() {
    constexpr std::string_view roots[] = {"/sqrt(Hz)", "/sqrt(s)"};
    for (std::size_t row = 0; row < std::size(units::rows); ++row) {
      if (units::rows[row].name.empty()) continue;  // a share has no density
      for (std::size_t per = 0; per < std::size(roots); ++per)
        for (const Spelling& spelling : units::rows[row].all_spellings())
          spellings[row][per].push_back(
              {texts.emplace_back(fmt::format("{}{}", spelling.text, roots[per])), spelling.factor, SpeltIn::noise});
    }
  }
};

const Densities& densities() {
  static const Densities all;
  return all;
}

bool is_of_a_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '^' ||
         static_cast<unsigned char>(c) >= 0x80;
}

/// Calls `use` with each spelling that expressions accept, and its unit.
template <class Use>
void each_in_expressions(Use&& use) {
  for (const Unit& unit : units::rows)
    for (const Spelling& spelling : unit.all_spellings())
      if (spelling.where == SpeltIn::all_files) use(unit, spelling);
}

}  // namespace

std::span<const Spelling> density_spellings(UnitName unit, DensityPer per) {
  return densities().spellings[unit.number()][static_cast<std::size_t>(per)];
}

std::optional<double> factor_in(std::span<const Spelling> spellings, std::string_view text) {
  const auto known = std::ranges::find(spellings, text, &Spelling::text);
  return known == spellings.end() ? std::nullopt : std::optional(known->factor);
}

std::optional<double> factor_of_spelling(std::string_view text) {
  for (const Unit& unit : units::rows)
    if (const auto factor = factor_in(unit.all_spellings(), text)) return factor;
  for (const auto& of_unit : densities().spellings)
    for (const std::vector<Spelling>& spellings : of_unit)
      if (const auto factor = factor_in(spellings, text)) return factor;
  return std::nullopt;
}

std::optional<WrittenUnit> leading_unit(std::string_view text) {
  std::optional<WrittenUnit> found;
  each_in_expressions([&](const Unit& unit, const Spelling& spelling) {
    if (!text.starts_with(spelling.text) || (found && found->text.size() > spelling.text.size())) return;
    const std::string_view rest = text.substr(spelling.text.size());
    if (rest.empty() || !is_of_a_word(rest.front())) found = {spelling.text, unit.name, spelling.factor};
  });
  return found;
}

std::string known_units() {
  std::string text;
  each_in_expressions([&](const Unit&, const Spelling& spelling) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", spelling.text);
  });
  return text;
}

std::string_view shown_unit(std::string_view unit) {
  const Unit* row = find_unit(unit);
  return row && !row->shown.empty() ? row->shown : unit;
}

}  // namespace rehearse
