#include "report_coverage.h"

#include <fmt/format.h>
#include <rehearse/report.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "report_page.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// Sets `source` and `unread` of an entry of `files`.
void add_source(ReportJson& covered) {
  const fs::path file = covered["file"].get<std::string>();
  covered["source"] = nullptr;
  covered["unread"] = "";
  std::error_code failed;
  if (fs::is_directory(file, failed)) {
    covered["unread"] = fmt::format("{} is a folder", file.string());
    return;
  }
  errno = 0;
  std::ifstream stream(file);
  ReportJson lines = ReportJson::array();
  for (std::string line; std::getline(stream, line);) {
    if (line.ends_with('\r')) line.pop_back();
    lines.push_back(std::move(line));
  }
  if (stream.eof())
    covered["source"] = std::move(lines);
  else
    covered["unread"] = fmt::format("{} can't be read: {}", file.string(), std::strerror(errno ? errno : EIO));
}

}  // namespace

Result<ReportJson> coverage_with_sources(const std::string& text) {
  if (text.empty()) return ReportJson(nullptr);
  ReportJson coverage = ReportJson::parse(text, nullptr, false);
  const auto has = [&coverage](const char* key, auto is) { return coverage.contains(key) && (coverage[key].*is)(); };
  if (!coverage.is_object() || !has("verdict", &ReportJson::is_string) || !has("lines", &ReportJson::is_number) ||
      !has("lines_executed", &ReportJson::is_number) || !has("recordings", &ReportJson::is_array) ||
      !has("files", &ReportJson::is_array))
    return error("this is no object of audit --coverage --json");
  for (ReportJson& file : coverage["files"]) add_source(file);
  return coverage;
}

ReportJson coverage_entry(BlobWriter& blobs, const ReportJson& coverage) {
  if (coverage.is_null()) return nullptr;
  ReportJson entry = blobs.text(coverage.dump(-1, ' ', false, ReportJson::error_handler_t::replace));
  entry["lines"] = coverage["lines"];
  entry["lines_executed"] = coverage["lines_executed"];
  return entry;
}

Result<std::uintmax_t> write_coverage_page(const std::string& coverage, const fs::path& file, const fs::path& page) {
  const auto form = REHEARSE_TRY(page.empty() ? report_page() : Result<fs::path>(page));
  const auto covered = REHEARSE_TRY(coverage_with_sources(coverage));
  if (covered.is_null()) return error("there is no coverage to show");
  auto report = REHEARSE_TRY(ReportFile::begin(file, form, std::vector<fs::path>{form}));
  BlobWriter blobs([&report](const std::string& id, ByteSpan coded) { report.put_blob(id, coded); });
  const std::size_t recordings = covered["recordings"].size();
  const std::string& verdict = covered["verdict"].get_ref<const std::string&>();
  ReportJson object{
      {"format", 1},
      {"title", recordings == 1 ? "1 recording" : fmt::format("{} recordings", recordings)},
      {"rehearse", REHEARSE_VERSION},
      {"verdict", {{"sentence", verdict}, {"besides", verdict}, {"state", "coverage"}, {"notes", ReportJson::array()}}},
      {"time_step", 1.0},
      {"begin", 0},
      {"end", 0},
      {"first", nullptr},
      {"call_stack", nullptr},
      {"coverage", coverage_entry(blobs, covered)}};
  for (const char* empty : {"runs", "expectations", "divergences", "worst", "control_times", "spans", "axes", "series",
                            "cameras", "events", "contacts", "robots", "meshes", "omitted"})
    object[empty] = ReportJson::array();
  REHEARSE_TRY(report.finish(object));
  return report.bytes();
}

}  // namespace rehearse
