#include "inputs_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

#include "base/text.h"

namespace rehearse {
namespace {

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < line.size();) {
    at = line.find_first_not_of(" \t\r", at);
    if (at == std::string_view::npos || line[at] == '#') break;
    const std::size_t end = std::min(line.size(), line.find_first_of(" \t\r", at));
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

class InputsReader {
 public:
  InputsReader(const FuzzSetup& setup, const std::filesystem::path& file) : setup_(setup), file_(file) {}
  Result<Inputs> read(const std::string& text);

 private:
  Result<void> read_line(const std::vector<std::string_view>& words);
  Result<void> read_ticks(const std::vector<std::string_view>& words);
  Diagnostic mistake(std::string message, std::string hint) const {
    Diagnostic found = error_in(file_.string(), std::move(message), std::move(hint));
    found.line = line_;
    return found;
  }

  const FuzzSetup& setup_;
  const std::filesystem::path& file_;
  int line_ = 0;
  std::optional<Inputs> inputs_;
};

Result<void> InputsReader::read_ticks(const std::vector<std::string_view>& words) {
  if (words.size() != 2 || words[0] != "ticks")
    return mistake("the first line that isn't a comment states no ticks", "expected as \"ticks 12\"");
  const auto ticks = number_in<int>(words[1]);
  if (!ticks || *ticks < 1 || *ticks > setup_.plan.ticks)
    return mistake(fmt::format("'{}' is no number of ticks", words[1]),
                   fmt::format("expected 1 to {}, the ticks of the test", setup_.plan.ticks));
  inputs_ = inputs_at_start(setup_.columns, *ticks);
  return {};
}

Result<void> InputsReader::read_line(const std::vector<std::string_view>& words) {
  if (words.size() != 5 || words[0] != "tick" || words[3] != "=")
    return mistake("a line is no change of an input", "expected as \"tick 3 SHOULDER/q = 0.5\"");
  const auto tick = number_in<int>(words[1]);
  if (!tick || *tick < 0 || *tick >= inputs_->ticks())
    return mistake(fmt::format("there is no tick '{}'", words[1]),
                   fmt::format("expected 0 to {}", inputs_->ticks() - 1));
  const auto column = std::ranges::find(setup_.columns, words[2], &InputColumn::name);
  if (column == setup_.columns.end()) {
    std::string names;
    for (const InputColumn& known : setup_.columns) names += (names.empty() ? "" : ", ") + known.name;
    return mistake(fmt::format("the test states no input '{}'", words[2]), fmt::format("it states {}", names));
  }
  const auto value = number_in<double>(words[4]);
  if (!value || !(*value >= column->low && *value <= column->high))
    return mistake(fmt::format("'{}' is no value of {}", words[4], column->name),
                   fmt::format("expected {} to {}", column->low, column->high));
  for (int later = *tick; later < inputs_->ticks(); ++later)
    inputs_->at(later, static_cast<std::size_t>(column - setup_.columns.begin())) = *value;
  return {};
}

Result<Inputs> InputsReader::read(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    ++line_;
    const auto words = words_of(line);
    if (words.empty()) continue;
    if (const auto done = inputs_ ? read_line(words) : read_ticks(words); !done) return done.errors();
  }
  if (!inputs_) return mistake("it states no ticks", "expected as \"ticks 12\"");
  return *std::move(inputs_);
}

}  // namespace

std::string text_of_inputs(const FuzzSetup& setup, const Inputs& inputs, const std::vector<std::string>& comments) {
  std::string text;
  for (const std::string& comment : comments) text += fmt::format("# {}\n", comment);
  text += fmt::format("ticks {}\n", inputs.ticks());
  for (const InputChange& change : changes_of(inputs, setup.columns))
    text += fmt::format("tick {} {} = {}\n", change.tick, setup.columns[change.column].name, change.value);
  return text;
}

Result<Inputs> inputs_of_text(const FuzzSetup& setup, const std::string& text, const std::filesystem::path& file) {
  return InputsReader(setup, file).read(text);
}

}  // namespace rehearse
