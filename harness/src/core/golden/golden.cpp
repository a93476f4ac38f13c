#include <fmt/format.h>
#include <rehearse/compare.h>
#include <rehearse/golden.h>
#include <rehearse/mcap.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <string_view>

#include "base/hashing.h"
#include "core/mcap/container.h"
#include "core/mcap/file_view.h"
#include "core/scenario/project.h"
#include "core/trace/run_facts.h"
#include "golden_files.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value ? value : "";
}

std::string text_of(const Diagnostics& diagnostics) {
  std::string text = to_string(diagnostics);
  if (text.ends_with('\n')) text.pop_back();
  return text;
}

/// First the faults of the run itself, then the result of the comparison.
std::string sentence_of(const Comparison& comparison, const SettleOptions& options) {
  const std::string compared = verdict(comparison, options.compare.until);
  const bool other_bits = options.exact && comparison.within && !comparison.equal;
  return fmt::format("{}{}{}{}", options.violation, options.violation.empty() ? "" : "; ",
                     other_bits ? "not the same bits: " : "", compared);
}

bool is_git_lfs_pointer(const fs::path& file) {
  const auto view = mcap::FileView::open(file);
  return view && mcap::container_of(view->bytes()) == mcap::Container::git_lfs_pointer;
}

/// Fails if the golden is a git-lfs pointer or has an unknown version; succeeds if it can't be read for other reasons.
Result<void> check_is_known(const fs::path& golden) {
  const auto reader = mcap::Reader::open(golden);
  if (reader) return check_trace_version((*reader)->metadata(), (*reader)->name());
  return is_git_lfs_pointer(golden) ? Result<void>(reader.errors()) : Result<void>();
}

/// Claims a golden for a recording of this process, by the golden's file and the recording's bytes. False: a different
/// recording has claimed it.
bool claim(const fs::path& golden, std::uint64_t content) {
  static std::map<fs::path, std::uint64_t> claims;
  return claims.emplace(golden.lexically_normal(), content).first->second == content;
}

/// "cd DIR && " if the project of these goldens isn't this folder's.
std::string step_to_project(const fs::path& goldens) {
  if (goldens.empty() || !environment("REHEARSE_PENDING").empty()) return {};
  std::error_code ignored;
  const auto project = find_project(goldens / "");
  if (!project || fs::equivalent(*project, find_project("./").value_or("/"), ignored)) return {};
  return fmt::format("cd {} && ", fs::proximate(*project, ignored).string());
}

}  // namespace

bool is_ci() { return environment("CI") == "true"; }

std::string acceptance_advice(const std::string& name, const fs::path& goldens) {
  if (is_ci())
    return fmt::format("if it is right: make this run on a machine of yours, accept it there, and commit the golden {}",
                       name);
  return fmt::format("if it is right: {1}rehearse golden accept {0}\nlook at it: {1}rehearse golden review {0}", name,
                     step_to_project(goldens));
}

std::string way_back(const std::string& files) {
  return fmt::format("git checkout -- {} brings back what was committed", files);
}

Result<GoldenMode> golden_mode() {
  const std::string word = environment("REHEARSE_GOLDEN");
  if (word.empty() || word == "check") return GoldenMode::check;
  if (word != "new" && word != "accept")
    return error(fmt::format("REHEARSE_GOLDEN is '{}'", word), "it may be check, new or accept");
  if (is_ci())
    return error(fmt::format("REHEARSE_GOLDEN is '{}', but CI is 'true': goldens are only checked there", word),
                 "accept them on a machine of yours, look at the digests, and commit them");
  return word == "new" ? GoldenMode::create : GoldenMode::accept;
}

fs::path pending_folder(const fs::path& inside) {
  const std::string stated = environment("REHEARSE_PENDING");
  if (!stated.empty()) return stated;
  std::error_code ignored;
  const fs::path project = find_project(inside).value_or(fs::current_path(ignored));
  const bool has_build = fs::is_regular_file(project / "build/CMakeCache.txt", ignored);
  const fs::path folder = project / (has_build ? "build/goldens/pending" : "rehearse-pending");
  fs::path from_here = folder.lexically_proximate(fs::current_path(ignored));
  return from_here.string().size() < folder.string().size() ? from_here : folder;
}

Result<fs::path> find_golden_folder(const fs::path& scenario) {
  const std::string stated = environment("REHEARSE_GOLDEN_DIR");
  if (!stated.empty()) return fs::path(stated);
  std::error_code ignored;
  if (const auto project = find_project(scenario)) return fs::relative(*project / "golden", ignored);
  return error(fmt::format("{} belongs to no project: no folder above it has a folder 'golden', a CMakeLists.txt, a "
                           "pyproject.toml or a pytest.ini",
                           scenario.string()),
               "make a folder 'golden', or name one by REHEARSE_GOLDEN_DIR");
}

GoldenStore::GoldenStore(fs::path folder, fs::path pending)
    : folder_(std::move(folder)), pending_(std::move(pending)) {}

fs::path noise_file_of(const fs::path& golden) { return fs::path(golden).replace_extension(".noise"); }

fs::path instructions_file_of(const fs::path& golden) { return fs::path(golden).replace_extension(".instructions"); }

fs::path GoldenStore::trace_file(const std::string& name) const { return folder_ / (name + ".mcap"); }
fs::path GoldenStore::digest_file(const std::string& name) const { return folder_ / (name + ".txt"); }
fs::path GoldenStore::pending_file(const std::string& name) const { return pending_ / (name + ".mcap"); }

bool GoldenStore::has(const std::string& name) const {
  std::error_code ignored;
  return fs::is_regular_file(trace_file(name), ignored);
}

Result<void> GoldenStore::check_digest(const std::string& name) const {
  const auto trace = REHEARSE_TRY(Trace::load_in_pieces(trace_file(name), [](const Trace&) {}));
  const auto expected = REHEARSE_TRY(digest_of(trace));
  const auto stated = read_text(digest_file(name));
  if (stated && *stated == expected) return {};
  std::error_code ignored;
  const bool interrupted = fs::exists(digest_file(name).string() + ".new", ignored);
  if (stated && stated->starts_with("digest ") && !stated->starts_with(digest_form))
    return error_in(digest_file(name).string(),
                    fmt::format("the digest of {} is in an older form", trace_file(name).string()),
                    "REHEARSE_GOLDEN=accept writes it anew, and doesn't change the recording");
  return error_in(digest_file(name).string(),
                  stated ? fmt::format("the digest doesn't describe {}", trace_file(name).string())
                         : fmt::format("the digest of {} is missing", trace_file(name).string()),
                  interrupted ? "an acceptance was interrupted: accept the run again"
                              : way_back(digest_file(name).string() + " " + trace_file(name).string()));
}

std::vector<std::string> GoldenStore::names() const {
  std::vector<std::string> names;
  std::error_code failed;
  for (fs::directory_iterator entry(folder_, failed), end; !failed && entry != end; entry.increment(failed))
    if (entry->path().extension() == ".mcap") names.push_back(entry->path().stem().string());
  return names;
}

Result<void> GoldenStore::keep_pending(const std::string& name, const Trace& actual) const {
  std::error_code failed;
  fs::create_directories(pending_, failed);
  if (!failed && !fs::equivalent(actual.file(), pending_file(name), failed))
    fs::copy_file(actual.file(), pending_file(name), fs::copy_options::overwrite_existing, failed);
  if (failed)
    return error(
        fmt::format("the trace of this run can't be kept as {}: {}", pending_file(name).string(), failed.message()));
  return {};
}

GoldenResult GoldenStore::fail_and_keep(const std::string& name, const Trace& actual, std::string message) const {
  GoldenResult result;
  result.message = std::move(message);
  if (const auto kept = keep_pending(name, actual); !kept)
    result.message += "\n" + text_of(kept.errors());
  else
    result.message += fmt::format("\nthis run: {}\n{}", pending_file(name).string(), acceptance_advice(name));
  return result;
}

GoldenResult GoldenStore::settle(const std::string& name, const Trace& actual, const std::vector<ToleranceRule>& rules,
                                 GoldenMode mode, const SettleOptions& options) {
  GoldenResult result;
  const bool wrong = !options.violation.empty();
  const auto content = hash_of_file(actual.file());
  if (!content) return {false, text_of(content.errors()), std::nullopt, false};
  const auto own = has(name) ? hash_of_file(trace_file(name)) : content;
  const bool is_copy = has(name) && own && *own == *content;  // a copy of the golden needs no claim
  if (!is_copy && !claim(trace_file(name), *content)) {
    result.message = fmt::format(
        "golden '{}' was claimed before by another recording of this process: give each recording its own "
        "test",
        name);
    return result;
  }
  const auto write = [&](std::string message) {
    const auto done = accept(name, actual.file());
    result.passed = result.written = done.ok();
    result.message = done ? std::move(message) : text_of(done.errors());
    return result;
  };
  if (!has(name)) {
    if (wrong) return fail_and_keep(name, actual, options.violation);
    if (mode != GoldenMode::check) return write(fmt::format("wrote the new golden {}", trace_file(name).string()));
    std::string hint = options.hint;
    if (hint.empty() && !is_ci()) hint = "REHEARSE_GOLDEN=new writes it";
    return fail_and_keep(
        name, actual,
        fmt::format("there is no golden {}{}", trace_file(name).string(), hint.empty() ? "" : " (" + hint + ")"));
  }
  if (const auto known = check_is_known(trace_file(name)); !known) {
    // The run itself is not at fault, so there is nothing to accept.
    result.message = "the golden can't be used: " + text_of(known.errors());
    return result;
  }
  const auto golden = Trace::load(trace_file(name));
  if (!golden) {
    if (mode == GoldenMode::accept && !wrong)
      return write(fmt::format("replaced {}, which could not be read", trace_file(name).string()));
    return fail_and_keep(
        name, actual,
        "the golden can't be used: " + text_of(golden.errors()) + "; " + way_back(trace_file(name).string()));
  }
  Comparison comparison = compare(*golden, actual, rules, options.compare);
  const auto digest = check_digest(name);
  const bool same = comparison.values > 0 && (options.exact ? comparison.equal : comparison.within);
  if (mode == GoldenMode::accept && !wrong && (!same || !digest)) {
    write(fmt::format("replaced {}: {}", trace_file(name).string(), verdict(comparison)));
  } else if (!same || wrong) {
    result = fail_and_keep(
        name, actual,
        sentence_of(comparison, options) + "\n" + table(comparison) + "golden: " + trace_file(name).string());
    result.message += picture_lines(write_picture_differences(*golden, actual, comparison, rules, pending_file(name)));
  } else if (!digest) {
    result.message = text_of(digest.errors());
  } else {
    result.passed = true;
    result.message = sentence_of(comparison, options);
    remove_run(pending_file(name));  // it is out of date
  }
  result.comparison = std::move(comparison);
  return result;
}

}  // namespace rehearse
