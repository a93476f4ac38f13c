#include "result_lines.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

namespace rehearse {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, case_verdict_count> verdict_names{"passed",  "violated", "differs",  "failed",
                                                                         "crashed", "hung",     "exploded", "invalid"};

template <class T>
Json json_of_optional(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// The bytes of a file up to the end of its last whole line.
off_t end_of_last_line(int file, off_t size) {
  for (off_t at = size; at > 0;) {
    char block[4096];
    const off_t begin = std::max<off_t>(0, at - static_cast<off_t>(sizeof block));
    const ssize_t got = ::pread(file, block, static_cast<std::size_t>(at - begin), begin);
    for (ssize_t i = got; i > 0; --i)
      if (block[i - 1] == '\n') return begin + i;
    if (got <= 0) return 0;
    at = begin;
  }
  return 0;
}

}  // namespace

std::string_view to_string(CaseVerdict verdict) { return verdict_names[static_cast<std::size_t>(verdict)]; }

bool CaseResult::repeats(const CaseResult& other) const {
  return verdict == other.verdict && sentence == other.sentence && tick == other.tick && hash == other.hash &&
         ticks == other.ticks && margins == other.margins && reached == other.reached;
}

Json json_of_result(const CaseResult& result) {
  Json margins = Json::array();
  for (const auto& margin : result.margins)
    margins.push_back(margin && std::isfinite(*margin) ? Json(*margin) : Json(nullptr));
  Json object{{"case", result.number},
              {"verdict", std::string(to_string(result.verdict))},
              {"sentence", result.sentence},
              {"reason", result.reason},
              {"tick", json_of_optional(result.tick)},
              {"hash", result.hash},
              {"ticks", result.ticks},
              {"margins", std::move(margins)},
              {"seconds", std::round(result.seconds * 1e6) / 1e6}};
  if (result.errors > 0) {
    object["errors"] = result.errors;
    object["first_error"] = result.first_error;
  }
  if (!result.reached.empty()) object["reached"] = result.reached;
  if (result.again) object["again"] = true;
  return object;
}

std::optional<CaseResult> result_of_json(const Json& object) {
  try {
    CaseResult result;
    result.number = object.at("case").get<std::int64_t>();
    const auto found = std::ranges::find(verdict_names, object.at("verdict").get<std::string>());
    if (found == verdict_names.end()) return std::nullopt;
    result.verdict = static_cast<CaseVerdict>(found - verdict_names.begin());
    result.sentence = object.at("sentence").get<std::string>();
    result.reason = object.at("reason").get<std::string>();
    if (!object.at("tick").is_null()) result.tick = object.at("tick").get<std::int64_t>();
    result.hash = object.at("hash").get<std::string>();
    result.ticks = object.at("ticks").get<std::int64_t>();
    for (const Json& margin : object.at("margins"))
      result.margins.push_back(margin.is_null() ? std::nullopt : std::optional(margin.get<double>()));
    if (object.contains("reached")) result.reached = object.at("reached").get<std::vector<bool>>();
    result.seconds = object.at("seconds").get<double>();
    result.errors = object.value("errors", std::int64_t{0});
    result.first_error = object.value("first_error", "");
    result.again = object.value("again", false);
    return result;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::string line_of(const CaseResult& result) {
  return json_of_result(result).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<CaseResult> result_of_line(std::string_view line) {
  const Json object = Json::parse(line, nullptr, false);
  return object.is_object() ? result_of_json(object) : std::nullopt;
}

std::string without_numbers(std::string_view sentence) {
  std::string text;
  for (std::size_t i = 0; i < sentence.size(); ++i) {
    const char c = sentence[i];
    const bool in_word =
        i > 0 && (std::isalpha(static_cast<unsigned char>(sentence[i - 1])) != 0 || sentence[i - 1] == '_');
    const bool in_number = text.ends_with('#') && (std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.' ||
                                                   c == 'e' || c == '-' || c == '+');
    if (in_number && !(c == '.' && (i + 1 == sentence.size() || sentence[i + 1] == ' '))) continue;
    text += std::isdigit(static_cast<unsigned char>(c)) != 0 && !in_word ? '#' : c;
  }
  return text;
}

Result<ResultFile> ResultFile::open(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor < 0) return error_in(file.string(), fmt::format("it can't be written: {}", std::strerror(errno)));
  ResultFile opened(file, descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0)
    return error_in(file.string(), "another process works on these cases", "wait for its end, or stop it");
  struct stat status {};
  const off_t whole = ::fstat(descriptor, &status) == 0 ? end_of_last_line(descriptor, status.st_size) : 0;
  if (whole < status.st_size && ::ftruncate(descriptor, whole) != 0)
    return error_in(file.string(), fmt::format("a cut line can't be removed: {}", std::strerror(errno)));
  return opened;
}

Result<void> ResultFile::append(const CaseResult& result) {
  const std::string line = line_of(result) + '\n';
  struct stat before {};
  ::fstat(descriptor_, &before);
  int reason = 0;
  for (std::string_view rest = line; !rest.empty() && reason == 0;) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno != EINTR) reason = errno;
    if (written > 0) rest.remove_prefix(static_cast<std::size_t>(written));
  }
  if (reason == 0) return {};
  const bool restored = ::ftruncate(descriptor_, before.st_size) == 0;
  return error_in(path_.string(),
                  fmt::format("the result of case {} can't be written: {}{}", result.number, std::strerror(reason),
                              restored ? "" : "; its cut line is removed by the next process"),
                  "make room, then: rehearse sweep resume");
}

}  // namespace rehearse
