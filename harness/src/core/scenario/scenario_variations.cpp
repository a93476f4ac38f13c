// `vary:` of a scenario: the parameters that a campaign varies, and the text with other values in their places.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>

#include "base/names.h"
#include "campaign_forms.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"
#include "scenario_variations.h"

namespace rehearse {
namespace {

constexpr Range any_number{-1e12, 1e12};

bool is_word_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// A step of a path: a key of a map, a name in a list, or an index.
struct Step {
  std::string name;  // empty: an index
  std::size_t index = 0;
  std::size_t end = 0;  // of the step in the path [bytes]
};

/// The steps of "bodies.Box.position[0]"; none: it isn't such a path.
std::optional<std::vector<Step>> steps_of(std::string_view path) {
  std::vector<Step> steps;
  for (std::size_t at = 0; at < path.size();) {
    Step step;
    if (path[at] == '[') {
      const std::size_t close = path.find(']', at);
      if (close == std::string_view::npos || close == at + 1) return std::nullopt;
      const std::string_view inside = path.substr(at + 1, close - at - 1);
      const char* const end = inside.data() + inside.size();
      const auto [stop, status] = std::from_chars(inside.data(), end, step.index);
      if (status != std::errc() || stop != end) step.name = inside;
      at = close + 1;
    } else {
      if ((path[at] == '.') == steps.empty()) return std::nullopt;
      if (!steps.empty()) ++at;
      const std::size_t stop = std::min(path.find_first_of(".[", at), path.size());
      step.name = path.substr(at, stop - at);
      if (step.name.empty()) return std::nullopt;
      at = stop;
    }
    step.end = at;
    steps.push_back(std::move(step));
  }
  return steps.empty() ? std::nullopt : std::optional(std::move(steps));
}

/// The name by which an element of a list is addressed; empty: by its index alone.
std::string name_of(const YamlNode& element) {
  for (const char* key : {"name", "library"})
    if (const YamlNode* name = element.kind == YamlNode::Kind::map ? find_key(element, key) : nullptr)
      return name->text;
  return {};
}

/// The node below `node`; null: there is none, and `names` has the existing names.
const YamlNode* node_below(const YamlNode& node, const Step& step, std::vector<std::string>& names) {
  names.clear();
  if (step.name.empty())
    return node.kind == YamlNode::Kind::list && step.index < node.items.size() ? node.items[step.index].get() : nullptr;
  if (node.kind == YamlNode::Kind::map) {
    for (const YamlNodePtr& key : node.keys) names.push_back(key->text);
    return find_key(node, step.name);
  }
  if (node.kind != YamlNode::Kind::list) return nullptr;
  for (const YamlNodePtr& item : node.items) {
    names.push_back(name_of(*item));
    if (names.back() == step.name) return item.get();
  }
  std::erase(names, "");
  return nullptr;
}

/// Bytes of the scenario's text.
struct TextSpan {
  std::size_t begin = 0, end = 0;
};

/// The place where a node begins; none: it isn't in the text.
std::optional<std::size_t> begin_of(const YamlNode& node, std::string_view text) {
  std::size_t at = 0;
  for (int line = 1; line < node.line; ++line) {
    at = text.find('\n', at);
    if (at == std::string_view::npos) return std::nullopt;
    ++at;
  }
  at += static_cast<std::size_t>(node.column) - 1;
  return at < text.size() ? std::optional(at) : std::nullopt;
}

/// True if a map is written in braces; `first_key` is the place of its first key.
bool is_in_braces(const YamlNode& map, std::size_t first_key, std::string_view text) {
  const auto begin = begin_of(map, text);
  const std::size_t before = text.substr(0, first_key).find_last_not_of(' ');
  return (begin && text[*begin] == '{') || (before != std::string_view::npos && text[before] == '{');
}

/// The place of a scalar in the text, without its quotes; none: it is written in another way than in one line.
std::optional<TextSpan> span_of(const YamlNode& node, std::string_view text) {
  const auto begin = begin_of(node, text);
  if (!begin) return std::nullopt;
  std::size_t at = *begin;
  if (text[at] == '"' || text[at] == '\'') ++at;
  if (text.substr(std::min(at, text.size()), node.text.size()) != node.text) return std::nullopt;
  return TextSpan{at, at + node.text.size()};
}

/// The place of the value of `key` in an option string: after "key:" or "key=", up to a blank, a comma or a brace.
std::optional<TextSpan> option_in(std::string_view options, std::string_view key) {
  for (std::size_t at = options.find(key); at != std::string_view::npos; at = options.find(key, at + 1)) {
    std::size_t value = at + key.size();
    if (at > 0 && is_word_letter(options[at - 1])) continue;
    value = std::min(options.find_first_not_of(' ', value), options.size());
    if (value == options.size() || (options[value] != ':' && options[value] != '=')) continue;
    value = std::min(options.find_first_not_of(' ', value + 1), options.size());
    const std::size_t end = std::min(options.find_first_of(" ,;}]", value), options.size());
    if (end > value) return TextSpan{value, end};
  }
  return std::nullopt;
}

class VariationReader {
 public:
  VariationReader(Findings& findings, const YamlNode& root, const Scenario& scenario)
      : findings_(findings), root_(root), scenario_(scenario) {}

  std::optional<Variation> read(const NamedEntry& entry);
  /// Finds the nominal value in the scenario's text.
  bool find_place(const YamlNode& path, Variation& variation);

 private:
  bool find_default(const YamlNode& map, std::span<const Step> steps, Variation& variation) const;
  void report_unstated(const YamlNode& path, std::string_view whole, const YamlNode& map,
                       const std::vector<Step>& steps, std::size_t at, std::vector<std::string> names) const;
  void read_bounds(const Keys& keys, Variation& variation, Distribution distribution);
  void read_normal(const YamlNode& node, Variation& variation);
  void read_values(const YamlNode& node, const char* label, Variation& variation);
  void read_steps(const YamlNode& node, Variation& variation);
  bool read_distribution(const YamlNode& node, const Keys& keys, Variation& variation);
  bool take_number(const YamlNode& path, Variation& variation);

  Findings& findings_;
  const YamlNode& root_;
  const Scenario& scenario_;
};

constexpr std::string_view distribution_keys[] = {"uniform", "log_uniform", "normal", "choice",
                                                  "grid",    "file",        "linked"};

void VariationReader::read_bounds(const Keys& keys, Variation& variation, Distribution distribution) {
  const bool logarithmic = distribution == Distribution::log_uniform;
  const char* const label = logarithmic ? "log_uniform" : "uniform";
  const YamlNode& node = *keys.find(label);
  const Range range = logarithmic ? Range{0.0, any_number.high, "", true} : any_number;
  variation.distribution = distribution;
  const auto bounds = read_numbers(findings_, node, label, 2, 2, range);
  if (!bounds) return;
  variation.low = (*bounds)[0];
  variation.high = (*bounds)[1];
  if (variation.low >= variation.high)
    findings_.error(node, fmt::format("{} ends at {}, which is not above its beginning", label, variation.high),
                    "expected [LOW, HIGH]");
}

void VariationReader::read_normal(const YamlNode& node, Variation& variation) {
  variation.distribution = Distribution::normal;
  const Keys keys(findings_, node, normal_form());
  if (!keys.is_map()) return;
  bound_normal_form().read(keys, variation);
  constexpr double farthest = 8.0;  // beyond it the normal distribution's tail has less than 1e-15
  const bool is_empty = variation.low >= variation.high ||
                        variation.low > variation.mean + farthest * variation.stddev ||
                        variation.high < variation.mean - farthest * variation.stddev;
  if (is_empty && keys.find("from") && keys.find("to"))
    findings_.error(node,
                    fmt::format("normal has no values from {} to {}: its mean is {}, its deviation {}", variation.low,
                                variation.high, variation.mean, variation.stddev),
                    "expected from below to, within 8 deviations of the mean");
}

/// Equal steps from a number to another, both included.
void VariationReader::read_steps(const YamlNode& node, Variation& variation) {
  const Keys keys(findings_, node, grid_form());
  GridSteps grid;
  bound_grid_form().read(keys, grid);
  const auto& [from, to, steps] = grid;
  for (int i = 0; i < steps; ++i)
    variation.values.push_back(fmt::format("{}", i + 1 == steps ? to : from + (to - from) * i / (steps - 1)));
}

void VariationReader::read_values(const YamlNode& node, const char* label, Variation& variation) {
  if (node.kind == YamlNode::Kind::list && node.items.empty())
    findings_.error(node, fmt::format("{} has no values", label), "expected at least one");
  for (const YamlNodePtr& item : read_list(findings_, node, label, "a list of values"))
    if (const auto text = read_text(findings_, *item, fmt::format("a value of {}", label)))
      variation.values.push_back(*text);
}

/// False if the distribution isn't stated, or twice.
bool VariationReader::read_distribution(const YamlNode& node, const Keys& keys, Variation& variation) {
  const auto count =
      std::ranges::count_if(distribution_keys, [&](std::string_view key) { return keys.find(key) != nullptr; });
  if (count != 1) {
    findings_.error(node, fmt::format("'{}' has {} distributions", variation.name, count),
                    "expected one of uniform, log_uniform, normal, choice, grid, file, linked");
    return false;
  }
  if (keys.find("uniform")) read_bounds(keys, variation, Distribution::uniform);
  if (keys.find("log_uniform")) read_bounds(keys, variation, Distribution::log_uniform);
  if (const YamlNode* normal = keys.find("normal")) read_normal(*normal, variation);
  if (const YamlNode* choice = keys.find("choice")) {
    variation.distribution = Distribution::choice;
    read_values(*choice, "choice", variation);
  }
  if (const YamlNode* grid = keys.find("grid")) {
    variation.distribution = Distribution::grid;
    grid->kind == YamlNode::Kind::map ? read_steps(*grid, variation) : read_values(*grid, "grid", variation);
  }
  if (keys.find("file")) {
    variation.distribution = Distribution::from_file;
    keys.read("file", variation.file);
    variation.column = variation.name;
    keys.read("column", variation.column);
  } else if (const YamlNode* column = keys.find("column")) {
    findings_.error(*column, "column is given without file", "it names a column of a CSV file");
  }
  if (keys.find("linked")) {
    variation.distribution = Distribution::linked;
    keys.read("linked", variation.expression);
  }
  return true;
}

/// Finds the default of a key that the map, or a map below it that isn't stated either, doesn't state. A value is
/// written before the last key of the map.
bool VariationReader::find_default(const YamlNode& map, std::span<const Step> steps, Variation& variation) const {
  const YamlNode* below = &map;
  std::string before, after;
  std::size_t step = 0;
  for (const YamlNode* absent; step < steps.size(); ++step, below = absent) {
    absent = findings_.find_absent_map(*below, steps[step].name);
    if (absent == nullptr) break;
    before += yaml_text(steps[step].name) + ": {";
    after += "}";
  }
  const auto* elements = step < steps.size() ? findings_.find_default(*below, steps[step].name) : nullptr;
  if (elements == nullptr || map.keys.empty()) return false;
  const bool is_element = step + 2 == steps.size() && steps[step + 1].name.empty();
  const std::size_t index = is_element ? steps[step + 1].index : 0;
  if ((step + 1 != steps.size() && !is_element) || is_element != (elements->size() > 1) || index >= elements->size())
    return false;
  const auto first = begin_of(*map.keys.front(), scenario_.text), last = begin_of(*map.keys.back(), scenario_.text);
  if (!first || !last) return false;
  before += yaml_text(steps[step].name) + ": ";
  if (is_element) {
    std::string rest;
    before += '[';
    for (std::size_t i = 0; i < index; ++i) before += (*elements)[i] + ", ";
    for (std::size_t i = index + 1; i < elements->size(); ++i) rest += ", " + (*elements)[i];
    after.insert(0, rest + "]");
  }
  after += is_in_braces(map, *first, scenario_.text)
               ? ", "
               : "\n" + std::string(static_cast<std::size_t>(map.keys.back()->column) - 1, ' ');
  variation.begin = variation.end = *last;
  variation.before = std::move(before);
  variation.after = std::move(after);
  variation.nominal = (*elements)[index];
  return true;
}

/// Reports the first step, from `at` on, that the map or a map below it neither states nor has as a default. `names`:
/// the stated names.
void VariationReader::report_unstated(const YamlNode& path, std::string_view whole, const YamlNode& map,
                                      const std::vector<Step>& steps, std::size_t at,
                                      std::vector<std::string> names) const {
  const YamlNode* below = &map;
  while (at + 1 < steps.size()) {
    const YamlNode* absent = findings_.find_absent_map(*below, steps[at].name);
    if (absent == nullptr) break;
    below = absent;
    names.clear();
    ++at;
  }
  const Step& step = steps[at];
  const std::vector<std::string> unstated = findings_.unstated_keys(*below);
  names.insert(names.end(), unstated.begin(), unstated.end());
  const std::string_view before = whole.substr(0, at == 0 ? 0 : steps[at - 1].end);
  const std::string what = step.name.empty() ? fmt::format("[{}]", step.index) : fmt::format("'{}'", step.name);
  const std::string hint = step.name.empty() || names.empty() ? "" : name_hint(step.name, names, "names") + "; ";
  findings_.error(
      path, fmt::format("the scenario states no {} in {}", what, before.empty() ? "it" : fmt::format("'{}'", before)),
      hint + "a value that varies needs its nominal value there, or a default that is a number or word");
}

bool VariationReader::find_place(const YamlNode& path, Variation& variation) {
  const auto steps = steps_of(variation.path);
  if (!steps) {
    expected(findings_, path, "path", "a path as bodies.Box.mass, bodies.Box.position[0] or pushes[0].force[1]");
    return false;
  }
  const YamlNode* node = &root_;
  const std::string_view text = scenario_.text;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < steps->size(); ++i) {
    const Step& step = (*steps)[i];
    const bool is_option = node->kind == YamlNode::Kind::scalar && !step.name.empty() && i + 1 == steps->size();
    const auto scalar = is_option ? span_of(*node, text) : std::nullopt;
    if (const auto option = scalar ? option_in(node->text, step.name) : std::nullopt) {
      variation.begin = scalar->begin + option->begin;
      variation.end = scalar->begin + option->end;
      variation.in_text = true;
      return true;
    }
    const YamlNode* next = node_below(*node, step, names);
    if (!next && node->kind == YamlNode::Kind::map && find_default(*node, std::span(*steps).subspan(i), variation))
      return true;
    if (!next) {
      report_unstated(path, variation.path, *node, *steps, i, std::move(names));
      return false;
    }
    node = next;
  }
  const auto span = node->kind == YamlNode::Kind::scalar ? span_of(*node, text) : std::nullopt;
  if (!span) {
    findings_.error(
        path,
        fmt::format("'{}' is {}", variation.path,
                    node->kind == YamlNode::Kind::scalar ? "written with an anchor, a tag or in several lines"
                                                         : describe(*node)),
        "expected the path of one number or word, written in one line");
    return false;
  }
  variation.begin = span->begin;
  variation.end = span->end;
  variation.in_text = node->quoted;
  return true;
}

/// Of a number with a unit the number alone is varied.
bool VariationReader::take_number(const YamlNode& path, Variation& variation) {
  std::string_view unit;
  const bool is_number = leading_number(variation.nominal, unit).has_value();
  const auto all_numbers = [&] {
    return std::ranges::all_of(variation.values, [](const std::string& value) {
      std::string_view rest;
      return leading_number(value, rest) && rest.empty();
    });
  };
  const bool of_values = variation.distribution == Distribution::choice || variation.distribution == Distribution::grid;
  if (of_values && (!is_number || !all_numbers())) return true;
  if (variation.distribution == Distribution::from_file && !is_number) return true;
  const std::string_view name = unit.starts_with(' ') ? unit.substr(1) : unit;
  if (!is_number || (!name.empty() && !factor_of_spelling(name))) {
    findings_.error(path, fmt::format("'{}' is '{}', not a number", variation.path, shortened(variation.nominal)),
                    "words and files vary by choice, grid or file");
    return false;
  }
  variation.end -= unit.size();
  variation.nominal.resize(variation.nominal.size() - unit.size());
  return true;
}

std::optional<Variation> VariationReader::read(const NamedEntry& entry) {
  Variation variation;
  variation.name = entry.name;
  variation.place = {scenario_.file, entry.key->line, entry.key->column};
  constexpr std::string_view reserved[] = {"tick", "time", "differs", "case", "verdict", "again"};
  const bool is_word = std::ranges::all_of(variation.name, is_word_letter) &&
                       std::isalpha(static_cast<unsigned char>(variation.name[0])) != 0;
  if (variation.name.empty() || !is_word || std::ranges::find(reserved, variation.name) != std::end(reserved)) {
    findings_.error(*entry.key, fmt::format("a parameter is named '{}'", shortened(variation.name)),
                    "expected a word of letters, digits and '_', none of tick, time, differs, case, verdict, again");
    return std::nullopt;
  }
  const Keys keys(findings_, *entry.value, parameter_form());
  if (!keys.is_map()) return std::nullopt;
  bound_parameter_form().read(keys, variation);
  const YamlNode* path = keys.require("path", "the place of its value, as bodies.Box.mass");
  if (!path || !read_distribution(*entry.value, keys, variation)) return std::nullopt;
  if (path->kind == YamlNode::Kind::scalar) variation.path = path->text;
  if (!find_place(*path, variation)) return std::nullopt;
  if (variation.before.empty())
    variation.nominal = scenario_.text.substr(variation.begin, variation.end - variation.begin);
  if (!take_number(*path, variation)) return std::nullopt;
  return variation;
}

/// True if both values would write one key, which the scenario doesn't state, into the same map.
bool write_the_same_key(const Variation& a, const Variation& b) {
  const auto key = [](const Variation& variation) { return variation.before.substr(0, variation.before.find(": ")); };
  return !a.before.empty() && a.begin == b.begin && key(a) == key(b);
}

}  // namespace

void read_variations(Findings& findings, const YamlNode& node, const YamlNode& root, Scenario& scenario) {
  if (node.kind != YamlNode::Kind::map) return expected(findings, node, "vary", "a map of NAME: {path: ..., ...}");
  VariationReader reader(findings, root, scenario);
  for (const NamedEntry& entry : read_entries(findings, node)) {
    auto variation = reader.read(entry);
    if (!variation) continue;
    for (const Variation& other : scenario.variations) {
      if (variation->begin < other.end && other.begin < variation->end)
        findings.error(*entry.key, fmt::format("'{}' and '{}' vary the same value", other.name, variation->name),
                       "leave one of them out");
      if (write_the_same_key(*variation, other))
        findings.error(
            *entry.key,
            fmt::format("'{}' and '{}' vary parts of what the scenario doesn't state", other.name, variation->name),
            "state its nominal value");
    }
    scenario.variations.push_back(*std::move(variation));
  }
}

std::optional<Variation> place_of(Findings& findings, const YamlNode& root, const Scenario& scenario,
                                  const std::string& path) {
  Variation place;
  place.name = place.path = path;
  place.place.file = scenario.file;
  if (!VariationReader(findings, root, scenario).find_place(root, place)) return std::nullopt;
  return place;
}

}  // namespace rehearse
