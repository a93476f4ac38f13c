// Records the scenarios of the fixtures in many ways, a row each, and prints one hash per row: of every message of
// every channel, including pictures and hashes of states. Rows are compared with the golden, or, for a scenario without
// one, with a plain run.
#include <fmt/format.h>
#include <rehearse/compare.h>
#include <rehearse/pin.h>
#include <rehearse/scenario.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "base/clock.h"
#include "matrix_rows.h"
#include "recording_content.h"

namespace rehearse::matrix {
namespace {

namespace fs = std::filesystem;

constexpr int as_expected = 0, not_as_expected = 1, bad_usage = 2, not_possible_here = 77;

struct Options {
  std::vector<std::string> rows;       // empty: all
  std::vector<std::string> scenarios;  // names; empty: all
  std::vector<std::string> builds;     // NAME=FOLDER
  double first = 0.0;                  // [s]; 0: whole runs
  fs::path keep;                       // where the recordings stay; empty: nowhere
  fs::path plain;                      // where the plain runs stay, and are taken from; empty: nowhere
  bool list = false;
};

/// A scenario, and the recording that is right.
struct Reference {
  std::string name;
  fs::path file;
  std::string golden;  // its name, or empty
  double time_step = 0.0;
  double seconds = 0.0;  // that are simulated
  bool whole = true;     // not only the first part of the run
  RecordingContent content;
  std::uint64_t file_hash = 0;             // of the plain run
  std::vector<ChannelContent> costs = {};  // of a plain run that counts them; empty: none of the rows does
};

struct Outcome {
  std::string made_by;
  std::uint64_t hash = 0;
  int differing = 0;                      // scenarios
  std::string verdict;                    // "same", or where not
  std::size_t counted = 0;                // controllers whose costs are compared
  std::vector<std::string> of_scenarios;  // lines of a row from another architecture
  bool unexpected = false;                // a scenario has other bits there, and had equal ones, or the reverse
};

/// A row's name as that of a folder, without blanks and colons: control_not_pinned.
std::string folder_name(const std::string& row) {
  std::string name;
  for (const char letter : row) {
    const bool plain = std::isalnum(static_cast<unsigned char>(letter)) != 0;
    if (plain || (!name.empty() && name.back() != '_')) name += plain ? letter : '_';
  }
  return name;
}

class Matrix {
 public:
  Matrix(const Options& options, fs::path folder) : options_(options), folder_(std::move(folder)) {}

  /// The reference: goldens and plain runs. `with_costs`: also a plain run that counts the costs of control().
  Result<void> prepare(bool with_costs);
  Result<Outcome> make(const Row& row) const;
  Outcome reference() const;
  std::size_t scenarios() const { return references_.size(); }
  double seconds() const;
  std::size_t goldens() const;

 private:
  Result<void> find_scenarios();
  Result<void> count_costs();
  Result<void> record(const Row& row, const fs::path& folder) const;
  Result<void> judge_elsewhere(const Reference& reference, const fs::path& file, bool is_equal, const Row& row,
                               Outcome& outcome) const;
  fs::path plain_folder() const {
    return options_.plain.empty() ? folder_ / "plain_run" : fs::absolute(options_.plain);
  }
  std::optional<std::uint64_t> end_of(const Reference& of) const;
  Result<std::string> made_by(const Row& row, const fs::path& folder) const;

  const Options& options_;
  fs::path folder_;
  std::vector<Reference> references_;
};

Result<void> Matrix::find_scenarios() {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(FIXTURES_DIR "/scenarios"))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::ranges::sort(files);
  for (const std::string& name : options_.scenarios)
    if (std::ranges::none_of(files, [&](const fs::path& file) { return file.stem() == name; }))
      return error(fmt::format("there is no scenario '{}' among the fixtures", name));
  for (const fs::path& file : files) {
    const std::string name = file.stem();
    const auto& wanted = options_.scenarios;
    if (!wanted.empty() && std::ranges::find(wanted, name) == wanted.end()) continue;
    const auto scenario = Scenario::load(file);
    if (!scenario) return scenario.errors();
    Reference found{name, file, scenario->golden, scenario->time_step, scenario->duration, true, {}, 0};
    if (options_.first > 0.0 && options_.first < found.seconds) {
      found.seconds = options_.first;
      found.whole = false;
    }
    references_.push_back(std::move(found));
  }
  return {};
}

/// The last state closes a run; where a run is only the first part of another, that one went on there.
std::optional<std::uint64_t> Matrix::end_of(const Reference& of) const {
  if (of.whole) return std::nullopt;
  return nanoseconds_of(std::llround(of.seconds / of.time_step), of.time_step);
}

Result<void> Matrix::record(const Row& row, const fs::path& folder) const {
  const fs::path program = row.build.empty() ? fs::path(PROBE) : fs::absolute(row.build / "bin/determinism_probe");
  std::vector<std::string> command{program.string(), "record", folder.string(),
                                   options_.first > 0.0 ? fmt::format("{}", options_.first) : "all"};
  if (!row.pins_itself) command.push_back("--not-pinned");
  if (row.nudged) command.push_back("--nudge");
  if (row.counts_costs) command.push_back("--costs");
  if (row.order == Order::beside_another) command.push_back("--beside");
  const auto start = [&](const std::vector<std::string>& files) {
    std::vector<std::string> words = command;
    words.insert(words.end(), files.begin(), files.end());
    return run(words, row.surroundings, folder / "log.txt");
  };
  std::vector<std::string> all;
  for (const Reference& reference : references_) all.push_back(reference.file.string());
  if (row.order == Order::after_another) all.push_back(all.front());  // the first one comes after the others, too
  if (row.order == Order::after_another || row.order == Order::beside_another) return start(all);
  for (const std::string& file : all)
    if (auto done = start(row.order == Order::twice ? std::vector{file, file} : std::vector{file}); !done) return done;
  return {};
}

/// Checks the conditions that the process reported: a row without the stated conditions proves nothing.
Result<std::string> Matrix::made_by(const Row& row, const fs::path& folder) const {
  std::ifstream stream(folder / "made_by.txt");
  std::string processor, compiler, pinned, memory;
  for (std::string* line : {&processor, &compiler, &pinned, &memory}) std::getline(stream, *line);
  if (processor.find(row.processor) == std::string::npos)
    return error(fmt::format("'{}' was made by {}", row.name, processor));
  const bool should_be_pinned = row.pins_itself || row.surroundings.variables.at("GLIBC_TUNABLES").has_value();
  if ((pinned == "pinned") != should_be_pinned) return error(fmt::format("'{}' was made {}", row.name, pinned));
  if (!row.memory.empty() && memory != row.memory)
    return error(fmt::format("'{}' was made with memory full of {}", row.name, memory));
  return processor + "; " + compiler;
}

/// Counting changes no other message.
Result<void> Matrix::count_costs() {
  const fs::path folder = folder_ / "plain_run_with_costs";
  fs::create_directories(folder);
  Row row = rows({}).front();
  row.counts_costs = true;
  if (auto done = record(row, folder); !done) return done;
  for (Reference& reference : references_) {
    auto counted = content_of(folder / (reference.name + ".mcap"), end_of(reference));
    if (!counted) return counted.errors();
    if (const std::string other = first_difference(reference.content, *counted, reference.time_step); !other.empty())
      return error(fmt::format("{}: a run whose costs are counted differs: {}", reference.name, other));
    reference.costs = std::move(counted->costs);
  }
  if (options_.keep.empty()) fs::remove_all(folder);
  return {};
}

Result<void> Matrix::prepare(bool with_costs) {
  if (auto found = find_scenarios(); !found) return found;
  const fs::path folder = plain_folder();
  if (options_.plain.empty() || !fs::exists(folder)) {
    fs::create_directories(folder);
    if (auto done = record(rows({}).front(), folder); !done) return done;
  }
  for (Reference& reference : references_) {
    const fs::path file = folder / (reference.name + ".mcap");
    auto plain = content_of(file, end_of(reference));
    if (!plain) return plain.errors();
    const auto hash = hash_of_file(file);
    if (!hash) return hash.errors();
    reference.content = *std::move(plain);
    reference.file_hash = *hash;
    if (reference.golden.empty()) continue;
    auto golden = content_of(fs::path(GOLDEN_DIR) / (reference.golden + ".mcap"), end_of(reference));
    if (!golden) return golden.errors();
    // a changed comment in a source file changes an attachment
    reference.content.channels = std::move(golden->channels);
  }
  return with_costs ? count_costs() : Result<void>();
}

Outcome Matrix::reference() const {
  Outcome outcome;
  outcome.made_by = fmt::format("goldens: {}, plain runs: {}", goldens(), scenarios() - goldens());
  std::uint64_t hash = 0;
  for (const Reference& reference : references_) hash = hash * 0x9e3779b97f4a7c15u + reference.content.hash();
  outcome.hash = hash;
  outcome.verdict = "what the others are compared with";
  return outcome;
}

/// What `rehearse diff` says of the scenario's recordings here and there, by the tolerances of the scenario.
Result<void> Matrix::judge_elsewhere(const Reference& reference, const fs::path& file, bool is_equal, const Row& row,
                                     Outcome& outcome) const {
  const std::vector<std::string>& equal = *row.equal_elsewhere;
  const bool was_equal = std::ranges::find(equal, reference.name) != equal.end();
  const bool right = is_equal == was_equal || !reference.whole;
  outcome.unexpected = outcome.unexpected || !right;
  std::string line = fmt::format("  {}{}: ", right ? "" : "WRONG: ", reference.name);
  if (is_equal) {
    outcome.of_scenarios.push_back(line + "same bits");
    return {};
  }
  const auto scenario = Scenario::load(reference.file);
  if (!scenario) return scenario.errors();
  CompareOptions what;
  if (!reference.whole) what.until = reference.seconds;
  const auto compared = compare(plain_folder() / file.filename(), file, scenario->tolerances, what);
  if (!compared) return compared.errors();
  outcome.of_scenarios.push_back(line + verdict(*compared, what.until));
  return {};
}

Result<Outcome> Matrix::make(const Row& row) const {
  const fs::path folder = folder_ / folder_name(row.name);
  fs::create_directories(folder);
  REHEARSE_TRY(record(row, folder));
  Outcome outcome;
  const auto maker = made_by(row, folder);
  if (!maker) return maker.errors();
  outcome.made_by = *maker;
  std::string first;
  for (const Reference& reference : references_) {
    const fs::path file = folder / (reference.name + ".mcap");
    const auto content = content_of(file, end_of(reference));
    if (!content) return content.errors();
    outcome.hash = outcome.hash * 0x9e3779b97f4a7c15u + content->hash();
    std::string difference = first_difference(reference.content, *content, reference.time_step);
    if (difference.empty() && row.same_file) {
      const auto hash = hash_of_file(file);
      if (!hash) return hash.errors();
      if (*hash != reference.file_hash) difference = "the same messages in another file";
    }
    if (difference.empty() && row.counts_costs) {
      difference = first_difference(reference.costs, content->costs, reference.time_step);
      outcome.counted += content->costs.size();
    }
    if (row.equal_elsewhere)
      if (auto judged = judge_elsewhere(reference, file, difference.empty(), row, outcome); !judged)
        return judged.errors();
    if (difference.empty()) continue;
    if (outcome.differing++ == 0) first = fmt::format("{}: {}", reference.name, difference);
  }
  outcome.verdict = first.empty() ? "same" : fmt::format("{} differ; {}", outcome.differing, first);
  if (first.empty() && row.counts_costs)
    outcome.verdict += fmt::format(", with the costs of {} controllers", outcome.counted);
  if (options_.keep.empty()) fs::remove_all(folder);
  return outcome;
}

double Matrix::seconds() const {
  double sum = 0.0;
  for (const Reference& reference : references_) sum += reference.seconds;
  return sum;
}

std::size_t Matrix::goldens() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(references_, [](const Reference& reference) { return !reference.golden.empty(); }));
}

Result<std::vector<Row>> chosen_rows(const Options& options) {
  std::vector<std::pair<std::string, fs::path>> builds;
  for (const std::string& build : options.builds) {
    const std::size_t equals = build.find('=');
    const fs::path folder = equals == std::string::npos ? "" : build.substr(equals + 1);
    if (!fs::exists(folder / "bin/determinism_probe"))
      return error(fmt::format("'{}' names no build that made determinism_probe", build),
                   "NAME=FOLDER, as clang=build-matrix-clang");
    builds.emplace_back(build.substr(0, equals), folder);
  }
  const std::vector<Row> all = rows(builds);
  std::vector<Row> chosen;
  for (const std::string& name : options.rows) {
    const auto found = std::ranges::find_if(all, [&](const Row& row) { return row.name == name; });
    if (found == all.end()) return error(fmt::format("there is no row '{}'", name), "matrix --list names them");
    chosen.push_back(*found);
  }
  return options.rows.empty() ? all : chosen;
}

void print_line(const std::string& row, const std::string& made_by, const Matrix& matrix, std::uint64_t hash,
                const std::string& verdict) {
  fmt::print("{:<48} {:<63} {:>3} {:>6.2f} s  {:016x}  {}\n", row, made_by, matrix.scenarios(), matrix.seconds(), hash,
             verdict);
  std::fflush(stdout);
}

/// Returns whether it is as it should be.
Result<bool> make_and_print(const Matrix& matrix, const Row& row) {
  if (!row.impossible.empty()) {
    fmt::print("{:<48} not made: {}\n", row.name, row.impossible);
    return true;
  }
  const auto outcome = matrix.make(row);
  if (!outcome) return outcome.errors();
  const bool right = row.equal_elsewhere ? !outcome->unexpected : (outcome->differing > 0) == row.has_to_differ;
  print_line(row.name, outcome->made_by, matrix, outcome->hash, (right ? "" : "WRONG: ") + outcome->verdict);
  for (const std::string& line : outcome->of_scenarios) fmt::print("{}\n", line);
  return right;
}

int refuse(const Diagnostics& errors) { return std::fputs(to_string(errors).c_str(), stderr), bad_usage; }

int print_matrix(const Options& options, const fs::path& folder) {
  const auto chosen = chosen_rows(options);
  if (!chosen) return refuse(chosen.errors());
  if (options.list) {
    for (const Row& row : *chosen) fmt::print("{}\n", row.name);
    return as_expected;
  }
  Matrix matrix(options, folder);
  const bool with_costs =
      std::ranges::any_of(*chosen, [](const Row& row) { return row.counts_costs && row.impossible.empty(); });
  if (auto done = matrix.prepare(with_costs); !done) return refuse(done.errors());
  fmt::print("{:<48} {:<63} {}\n", "", "made by", "scenarios, simulated; hash of all messages");
  const Outcome reference = matrix.reference();
  print_line("the reference", reference.made_by, matrix, reference.hash, reference.verdict);
  bool all_right = true;
  for (const Row& row : *chosen) {
    const auto right = make_and_print(matrix, row);
    if (!right) return refuse(right.errors());
    all_right = all_right && *right;
  }
  if (!addresses_are_random()) fmt::print("this kernel randomises no addresses\n");
  if (chosen->size() == 1 && !chosen->front().impossible.empty()) return not_possible_here;
  return all_right ? as_expected : not_as_expected;
}

int run_main(int argc, char** argv) {
  CLI::App app("The scenarios of the fixtures, recorded in many ways: a row each, and one hash a row.");
  Options options;
  app.add_option("--row", options.rows, "Only the row of that name; may be repeated")->allow_extra_args(false);
  app.add_option("--build", options.builds, "NAME=FOLDER: also a row that another build makes")
      ->allow_extra_args(false);
  app.add_option("--first", options.first, "Only the first so many seconds of each scenario")
      ->check(CLI::PositiveNumber);
  app.add_option("--keep", options.keep, "A folder in which all recordings stay");
  app.add_option("--plain", options.plain, "The folder of the plain runs: made if it isn't there, else they are taken");
  app.add_flag("--list", options.list, "Only the names of the rows");
  app.add_option("SCENARIO", options.scenarios, "Only these, by name");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& wrong) {
    return app.exit(wrong) == 0 ? as_expected : bad_usage;
  }
  const fs::path folder = options.keep.empty()
                              ? fs::temp_directory_path() / ("rehearse_matrix_" + std::to_string(getpid()))
                              : fs::absolute(options.keep);
  const int status = print_matrix(options, folder);
  std::error_code ignored;
  if (options.keep.empty()) fs::remove_all(folder, ignored);
  return status;
}

}  // namespace
}  // namespace rehearse::matrix

int main(int argc, char** argv) {
  rehearse::pin_process(argv);
  try {
    return rehearse::matrix::run_main(argc, argv);
  } catch (const std::exception& problem) {  // the file system's: no space, no right to write
    std::fprintf(stderr, "error: %s\n", problem.what());
    return rehearse::matrix::bad_usage;
  }
}
