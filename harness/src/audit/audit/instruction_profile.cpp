#include "instruction_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "symbols.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_lines = 10;
constexpr std::string_view title_of_profile = "desc: Trigger: Client Request: tick ";

/// Functions of the host between the two marks of a call; their instructions aren't the controller's.
bool is_hosts(std::string_view function) {
  return function.find("rehearse::ControllerHost::control()") != std::string_view::npos ||
         function.find("rehearse::(anonymous namespace)::AuditWatch::") != std::string_view::npos ||
         function.find("rehearse::WatchedControl::") != std::string_view::npos;
}

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

/// Removes a number and the blanks behind it.
template <class Number>
std::optional<Number> take_number(std::string_view& text, int base = 10) {
  Number number{};
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (failed != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  while (text.starts_with(' ')) text.remove_prefix(1);
  return number;
}

/// The names of one kind. A name is written once with a number, "(7) filter.cpp", and later as "(7)".
class ProfileNames {
 public:
  /// The index of the name in a reference; nullopt: it isn't a reference.
  std::optional<int> find(std::string_view reference) {
    if (!take_prefix(reference, "(")) return std::nullopt;
    const auto index = take_number<int>(reference);
    if (!index || !take_prefix(reference, ")")) return std::nullopt;
    if (take_prefix(reference, " ")) names_[*index] = reference;
    return index;
  }
  const std::string& operator[](int index) { return names_[index]; }

 private:
  std::map<int, std::string> names_;
};

/// Reads the profiles of a file line by line, and holds the addresses of the most expensive call of each controller.
class ProfileReader {
 public:
  explicit ProfileReader(const std::map<std::string, fs::path>& libraries) : libraries_(libraries) {}

  /// False: the line has another form than the format's.
  bool add(std::string_view line);
  std::map<std::string, InstructionCounts> finish();

 private:
  bool begin(std::string_view title);
  void end();
  bool take_name(std::string_view line, bool& known);
  bool add_cost(std::string_view line);

  const std::map<std::string, fs::path>& libraries_;
  ProfileNames objects_, functions_;
  int object_ = -1, function_ = -1, called_object_ = -1;
  bool is_call_ = false;  // the next cost is that of a call
  std::string controller_;
  std::int64_t tick_ = -1;
  std::uint64_t sum_ = 0;
  std::map<std::uint64_t, std::uint64_t> by_address_;  // in the controller's library
  std::map<std::string, InstructionCounts> counts_;
  std::map<std::string, std::map<std::uint64_t, std::uint64_t>> most_;  // of the call with most instructions
};

/// The lines of a library with most instructions, by their addresses.
std::vector<InstructionCounts::Line> lines_of(const fs::path& library,
                                              const std::map<std::uint64_t, std::uint64_t>& by_address) {
  const Symbols symbols(library);
  std::map<std::pair<std::string, std::string>, std::uint64_t> sums;
  for (const auto& [address, count] : by_address) {
    Symbols::Found found = symbols.find(address);
    if (found.function.empty()) found.function = symbols.address_text(address);
    sums[{std::move(found.function), std::move(found.line)}] += count;
  }
  std::vector<InstructionCounts::Line> lines;
  for (const auto& [place, count] : sums) lines.push_back({place.first, place.second, count});
  std::ranges::stable_sort(lines, std::greater(), &InstructionCounts::Line::instructions);
  if (lines.size() > most_lines) lines.resize(most_lines);
  return lines;
}

bool ProfileReader::begin(std::string_view title) {
  end();
  const auto tick = take_number<std::int64_t>(title);
  if (!tick || !take_prefix(title, "of ")) return false;
  tick_ = *tick;
  controller_ = title;
  return libraries_.contains(controller_);
}

void ProfileReader::end() {
  if (tick_ >= 0) {
    InstructionCounts& counts = counts_[controller_];
    counts.calls.push_back({tick_, sum_});
    if (counts.calls.size() == 1 || (tick_ > 0 && (counts.most.tick == 0 || sum_ > counts.most.instructions))) {
      counts.most = counts.calls.back();
      most_[controller_] = std::move(by_address_);
    }
  }
  tick_ = -1;
  sum_ = 0;
  by_address_.clear();
}

/// Takes a line that names an object or a function, or a file, which the address names as well; `known`: it is one.
bool ProfileReader::take_name(std::string_view line, bool& known) {
  known = true;
  std::optional<int> index;
  if (take_prefix(line, "ob=")) {
    index = objects_.find(line);
    object_ = called_object_ = index.value_or(-1);
  } else if (take_prefix(line, "cob=")) {
    index = objects_.find(line);
    called_object_ = index.value_or(-1);
  } else if (take_prefix(line, "fn=")) {
    index = functions_.find(line);
    function_ = index.value_or(-1);
  } else if (take_prefix(line, "cfn=")) {
    index = functions_.find(line);
  } else {
    known = line.starts_with("fl=") || line.starts_with("fi=") || line.starts_with("fe=") || line.starts_with("cfi=") ||
            line.starts_with("cfl=");
    return true;
  }
  return index.has_value();
}

/// Takes "0x1139 31 400": address, line, instructions.
bool ProfileReader::add_cost(std::string_view line) {
  if (!take_prefix(line, "0x")) return false;
  const auto address = take_number<std::uint64_t>(line, 16);
  const auto number = take_number<int>(line);
  const auto cost = take_number<std::uint64_t>(line);
  if (!address || !number || !cost || !line.empty()) return false;
  const bool is_call = std::exchange(is_call_, false);
  const int called = std::exchange(called_object_, object_);
  const fs::path& library = libraries_.find(controller_)->second;
  if (!is_call && !is_hosts(functions_[function_])) sum_ += *cost;
  // A call of another library costs the line that makes it; a call of a function of its own costs that one's lines.
  if (objects_[object_] == library && (!is_call || objects_[called] != library)) by_address_[*address] += *cost;
  return true;
}

bool ProfileReader::add(std::string_view line) {
  if (take_prefix(line, title_of_profile)) return begin(line);
  if (tick_ < 0 && line.find('=') == std::string_view::npos) return true;  // the head, and code outside of control()
  bool known = false;
  if (!take_name(line, known)) return false;
  if (known || tick_ < 0) return true;
  if (line.starts_with("calls=")) return is_call_ = true;
  if (line.starts_with("totals:")) end();
  return line.starts_with("0x") ? add_cost(line) : true;  // others describe the profile
}

std::map<std::string, InstructionCounts> ProfileReader::finish() {
  end();
  for (auto& [controller, counts] : counts_)
    counts.lines = lines_of(libraries_.find(controller)->second, most_[controller]);
  return std::move(counts_);
}

}  // namespace

std::string grouped(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, ",");
  return digits;
}

std::string profile_title(const std::string& controller, std::int64_t tick) {
  return fmt::format("tick {} of {}", tick, controller);
}

Result<std::map<std::string, InstructionCounts>> read_instruction_profiles(
    const fs::path& file, const std::map<std::string, fs::path>& libraries) {
  std::ifstream stream(file);
  if (!stream) return error(fmt::format("there is no profile {}: valgrind didn't count", file.string()));
  ProfileReader reader(libraries);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number)
    if (!reader.add(line)) {
      Diagnostic unknown = error("this line isn't known in a profile of callgrind: " + line);
      unknown.file = file.string();
      unknown.line = number;
      return unknown;
    }
  return reader.finish();
}

std::uint64_t InstructionCounts::median() const {
  std::vector<std::uint64_t> sorted;
  for (const Call& call : calls)
    if (call.tick > 0 || calls.size() == 1) sorted.push_back(call.instructions);
  if (sorted.empty()) return 0;
  std::ranges::stable_sort(sorted);
  return sorted[(sorted.size() - 1) / 2];
}

std::string instructions_sentence(const std::string& controller, const InstructionCounts& counts) {
  if (counts.calls.empty()) return fmt::format("control() of {} ran in no tick", controller);
  const InstructionCounts::Call& most = counts.most;
  const bool all_equal = std::ranges::all_of(counts.calls, [&](const InstructionCounts::Call& call) {
    return call.tick == 0 || call.instructions == most.instructions;
  });
  std::string text =
      all_equal
          ? fmt::format("control() of {} takes {} instructions in each tick", controller, grouped(most.instructions))
          : fmt::format("control() of {} takes at most {} instructions, at tick {}, and {} in the median tick",
                        controller, grouped(most.instructions), most.tick, grouped(counts.median()));
  if (counts.lines.empty() || most.instructions == 0) return text;
  const InstructionCounts::Line& first = counts.lines.front();
  const double share = 100.0 * static_cast<double>(first.instructions) / static_cast<double>(most.instructions);
  return text + fmt::format(": {:.3g} % of them in {}{}", share, first.function,
                            first.line.empty() ? "" : fmt::format(" ({})", first.line));
}

}  // namespace rehearse
