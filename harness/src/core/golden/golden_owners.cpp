// The tests that compare with each golden, as reported by the tests when they run. Names are made by macros, parameters
// and types, so a search of the sources doesn't find them.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/golden.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <set>
#include <string_view>
#include <utility>

#include "base/names.h"
#include "golden_files.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// The folder with a file for each golden, which has a line for each test.
fs::path owners_folder(const fs::path& pending) { return pending / ".owners"; }

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

/// One test that compares with a golden; a line of the golden's file, its parts between tabs.
struct OwnerNote {
  std::string test;
  fs::path program;  // relative to the project if it is below
  fs::path source;   // likewise; empty: unknown, or no owner

  bool is_of_same_program(const OwnerNote& other) const { return program.filename() == other.program.filename(); }
};

std::string line_of(const OwnerNote& note) {
  return fmt::format("{}\t{}\t{}", note.test, note.program.string(), note.source.string());
}

OwnerNote note_of(const std::string& line) {
  const std::size_t program = std::min(line.find('\t'), line.size());
  const std::size_t source = std::min(line.find('\t', program + 1), line.size());
  return {line.substr(0, program), line.substr(std::min(program + 1, line.size()), source - program - 1),
          line.substr(std::min(source + 1, line.size()))};
}

/// The notes of one golden in their order: of one test in one program the last.
std::vector<OwnerNote> notes_in(const fs::path& file) {
  std::vector<OwnerNote> notes;
  for (const std::string& line : lines_of(file)) {
    if (line.find('\t') == std::string::npos) continue;  // of an older version
    OwnerNote note = note_of(line);
    std::erase_if(notes,
                  [&](const OwnerNote& other) { return other.test == note.test && other.is_of_same_program(note); });
    notes.push_back(std::move(note));
  }
  return notes;
}

/// The project of the goldens.
fs::path project_of(const GoldenStore& goldens) {
  std::error_code failed;
  const fs::path folder = fs::weakly_canonical(goldens.folder(), failed);
  return failed ? fs::path() : folder.parent_path();
}

/// The file, relative to the project if it is below.
fs::path within(const fs::path& project, const fs::path& file) {
  const fs::path inside = file.is_absolute() ? file.lexically_relative(project) : fs::path();
  return inside.empty() || *inside.begin() == ".." ? file.lexically_normal() : inside;
}

bool is_word_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// The end of the first such word from `at` on; npos: there is none.
std::size_t end_of_word(std::string_view text, std::string_view word, std::size_t at) {
  for (at = text.find(word, at); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_word_letter(text[at - 1])) && (end == text.size() || !is_word_letter(text[end]))) return end;
  }
  return std::string_view::npos;
}

/// True if the text has "SUITE, TEST", as the macros of tests do.
bool has_pair(std::string_view text, std::string_view suite, std::string_view test) {
  constexpr std::string_view blanks = " \t\r\n";
  for (std::size_t at = end_of_word(text, suite, 0); at != std::string_view::npos; at = end_of_word(text, suite, at)) {
    std::size_t next = text.find_first_not_of(blanks, at);
    if (next == std::string_view::npos || text[next] != ',') continue;
    next = text.find_first_not_of(blanks, next + 1);
    if (next != std::string_view::npos && end_of_word(text.substr(next), test, 0) == test.size()) return true;
  }
  return false;
}

/// True if the source has the test: a test that was moved or renamed leaves its note behind. Of a parameterised or
/// typed test ("All-Walker.Stops-0") the words are searched; of a test whose name a macro makes, nothing is known.
bool has_test(const fs::path& source, std::string_view name) {
  const auto text = read_text(source);
  const std::size_t dot = name.find('.');
  if (!text || dot == std::string_view::npos) return false;
  if (name.find('-') == std::string_view::npos) return has_pair(*text, name.substr(0, dot), name.substr(dot + 1));
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t end = std::min(name.find_first_of(".-", at), name.size());
    const std::string_view word = name.substr(at, end - at);
    const bool is_number = word.find_first_not_of("0123456789") == std::string_view::npos;
    if (!is_number && end_of_word(*text, word, 0) == std::string_view::npos) return false;
    at = end + 1;
  }
  return true;
}

/// The sources with the test of the golden's name, if there are several.
std::vector<std::string> sources_of(const std::vector<OwnerNote>& notes, const std::string& golden,
                                    const fs::path& project) {
  std::set<std::string> sources;
  for (const OwnerNote& note : notes)
    if (note.test == golden && !note.source.empty()) sources.insert(note.source.string());
  if (sources.size() > 1)
    std::erase_if(sources, [&](const auto& source) { return !has_test(project / source, golden); });
  return {sources.begin(), sources.end()};
}

/// The tests of each program, "A.B, A.C of PROGRAM".
std::vector<std::string> tests_of(const std::vector<OwnerNote>& notes) {
  std::map<std::string, std::pair<std::string, std::set<std::string>>> programs;  // by file name
  for (const OwnerNote& note : notes) {
    auto& [program, tests] = programs[note.program.filename().string()];
    program = note.program.string();
    tests.insert(note.test);
  }
  std::vector<std::string> texts;
  for (const auto& [name, program] : programs)
    texts.push_back(fmt::format("{} of {}", fmt::join(program.second, " and "), program.first));
  return texts;
}

GoldenOwners owners_in(const fs::path& file, const fs::path& project) {
  const std::vector<OwnerNote> notes = notes_in(file);
  GoldenOwners owners;
  owners.tests = tests_of(notes);
  owners.sources = sources_of(notes, file.filename().string(), project);
  return owners;
}

}  // namespace

void report_golden_owner(const GoldenStore& goldens, const std::string& golden, const std::string& test,
                         const fs::path& source) {
  if (golden.empty() || golden.find('/') != std::string::npos) return;
  const fs::path file = owners_folder(goldens.where_runs_wait()) / golden;
  const fs::path project = project_of(goldens);
  std::error_code failed;
  const std::string line =
      line_of({test, within(project, fs::read_symlink("/proc/self/exe", failed)), within(project, source)});
  fs::create_directories(file.parent_path(), failed);
  const std::vector<std::string> lines = lines_of(file);
  if (std::ranges::find(lines, line) != lines.end()) return;
  std::ofstream(file, std::ios::app) << line + "\n";  // in one write, because tests run in parallel
}

GoldenOwners reported_owners_of(const GoldenStore& goldens, const std::string& golden) {
  return owners_in(owners_folder(goldens.where_runs_wait()) / golden, project_of(goldens));
}

std::map<std::string, GoldenOwners> reported_golden_owners(const GoldenStore& goldens) {
  std::map<std::string, GoldenOwners> owners;
  const fs::path project = project_of(goldens);
  std::error_code failed;
  for (fs::directory_iterator entry(owners_folder(goldens.where_runs_wait()), failed), end; !failed && entry != end;
       entry.increment(failed))
    owners[entry->path().filename().string()] = owners_in(entry->path(), project);
  return owners;
}

std::string hint_for_missing(const GoldenStore& goldens, const std::string& golden) {
  const fs::path project = project_of(goldens), notes = owners_folder(goldens.where_runs_wait());
  const std::vector<OwnerNote> notes_of_golden = notes_in(notes / golden);
  const auto is_used = [&](const std::string& name) {
    const auto has_it = [&](const OwnerNote& note) {
      return !note.source.empty() && has_test(project / note.source, name);
    };
    // a test that never ran here has no note, but may be in the source of the test that searches its golden
    return std::ranges::any_of(notes_in(notes / name), has_it) || std::ranges::any_of(notes_of_golden, has_it) ||
           find_golden_owners(goldens.folder(), {project}).contains(name);
  };
  for (const std::string& name : near_names(golden, goldens.names()))
    if (!is_used(name))
      return fmt::format(
          "golden '{0}' has nearly that name, and no test of that name is known: correct the test's "
          "name, or rename {1} and its .txt",
          name, goldens.trace_file(name).string());
  return {};
}

}  // namespace rehearse
