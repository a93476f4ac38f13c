#include "report_page.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <rehearse/report.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iterator>

#include "base/replaceable.h"
#include "base/write_hint.h"
#include "core/trace/message_json.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view place_of_data = "<!-- REHEARSE DATA -->";
constexpr std::string_view doctype = "<!doctype html>";

Result<std::string> read_page(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(stream)), {});
  if (!stream) return error_in(file.string(), "the page of reports can't be read");
  if (text.find(place_of_data) == std::string::npos)
    return error_in(file.string(), fmt::format("it is no page of reports: there is no {} in it", place_of_data));
  return text;
}

/// The head without its doctype line: the first line of a report replaces it.
std::string_view without_doctype(std::string_view head) {
  const bool has = head.size() >= doctype.size() &&
                   std::equal(doctype.begin(), doctype.end(), head.begin(), [](char wanted, char letter) {
                     return wanted == std::tolower(static_cast<unsigned char>(letter));
                   });
  return has ? head.substr(doctype.size()) : head;
}

}  // namespace

fs::path beside_library(std::initializer_list<const char*> files) {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&beside_library), &info) == 0 || !info.dli_fname) return {};
  std::error_code ignored;
  const fs::path library = fs::canonical(info.dli_fname, ignored);
  for (const char* file : files) {
    const fs::path found = (library.parent_path() / file).lexically_normal();
    if (fs::is_regular_file(found, ignored)) return found;
  }
  return {};
}

Result<fs::path> report_page() {
  if (const char* stated = std::getenv("REHEARSE_REPORT_PAGE"); stated && *stated) return fs::path(stated);
  if (const fs::path page = beside_library({REHEARSE_PAGE_IN_BUILD, REHEARSE_PAGE_INSTALLED}); !page.empty())
    return page;
  return error(
      "the page of reports was not built: Node.js, npm, or a package of npm was missing when Rehearse was "
      "configured",
      "install nodejs and npm, run npm ci in tools/report, then configure and build again; tools/setup does the first "
      "two");
}

std::string report_link(const fs::path& report, std::optional<std::int64_t> tick) {
  constexpr std::string_view plain = "/-._~";
  std::error_code ignored;
  std::string link = "file://";
  for (const char c : fs::absolute(report, ignored).lexically_normal().string()) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (is_letter || plain.find(c) != std::string_view::npos)
      link += c;
    else
      link += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return tick ? link + fmt::format("#tick={}", *tick) : link;
}

Result<ReportFile> ReportFile::begin(const fs::path& file, const fs::path& page, std::span<const fs::path> sources) {
  REHEARSE_TRY(check_replaceable(file, report_magic, "report"));
  const auto text = REHEARSE_TRY(read_page(page));
  auto draft = REHEARSE_TRY(mcap::Draft::begin(file, sources));
  const std::size_t place = text.find(place_of_data);
  ReportFile report(std::move(draft), file, text.substr(place + place_of_data.size()));
  if (!report.stream_)
    return error_in(file.string(), "the report can't be written", write_hint(file, "name another file with -o"));
  report.put(report_magic);
  report.put(without_doctype(std::string_view(text).substr(0, place)));
  return report;
}

ReportFile::ReportFile(mcap::Draft draft, fs::path file, std::string tail)
    : draft_(std::move(draft)),
      file_(std::move(file)),
      stream_(draft_.file(), std::ios::binary),
      tail_(std::move(tail)) {}

void ReportFile::put(std::string_view text) {
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
  bytes_ += text.size();
}

void ReportFile::put_data(std::string_view text) {
  put(text);
  data_bytes_ += text.size();
}

void ReportFile::put_blob(const std::string& id, ByteSpan coded) {
  line_ = fmt::format("<script type=\"text/plain\" id=\"{}\">", id);
  append_base64(line_, std::as_bytes(coded));
  line_ += "</script>\n";
  put_data(line_);
}

Result<void> ReportFile::finish(const ReportJson& object) {
  const std::string json = object.dump(-1, ' ', false, ReportJson::error_handler_t::replace);
  std::string text = "<script type=\"application/json\" id=\"report\">";
  for (const char letter : json) {  // no text in it may end the element, or begin a comment
    if (letter == '<')
      text += "\\u003c";
    else
      text += letter;
  }
  put_data(text + "</script>\n");
  put(tail_);
  stream_.close();
  if (!stream_) return error_in(file_, "the report can't be written", "is the disk full?");
  return draft_.finish();
}

}  // namespace rehearse
