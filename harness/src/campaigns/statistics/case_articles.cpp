#include "case_articles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "campaigns/plan/campaign_folder.h"
#include "viewing/report/html_text.h"

namespace rehearse {
namespace {

constexpr std::size_t most_dots = 2000;  // of a kind

std::string title_of(const CaseTable& table, std::size_t number) {
  return fmt::format("case {}: {}", number, to_string(*table.verdicts[number]));
}

/// A link to the recording of a case; empty: it isn't kept.
std::string link_to_trace(const Campaign& campaign, const CaseTable& table, std::size_t number) {
  CaseResult result;
  result.number = static_cast<std::int64_t>(number);
  result.verdict = *table.verdicts[number];
  const std::filesystem::path file = kept_trace_file(campaign.folder(), result);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return "";
  return fmt::format(" <a href=\"{0}/{1}\">{1}</a>", file.parent_path().filename().string(), file.filename().string());
}

std::string article_of(const Campaign& campaign, const CaseTable& table, std::size_t number) {
  const std::vector<std::string> values = campaign.values_of(static_cast<std::int64_t>(number));
  const std::vector<Variation>& variations = campaign.scenario().variations;
  std::string text = fmt::format("<article class=\"case\" id=\"case-{}\"><b>{}</b>", number, title_of(table, number));
  if (!table.passed(number)) text += ": " + html_text(table.reason_texts[table.reasons[number]]);
  text += "<br>";
  for (std::size_t i = 0; i < values.size(); ++i)
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", html_text(variations[i].name), html_text(values[i]));
  text += fmt::format("<br><code>rehearse sweep case {} {}</code>", number,
                      html_text(campaign.folder().lexically_normal().filename().string()));
  return text + link_to_trace(campaign, table, number) + "</article>\n";
}

}  // namespace

std::vector<std::size_t> drawn_cases(const CaseTable& table, bool passed) {
  std::vector<std::size_t> cases, drawn;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.has(i) && table.passed(i) == passed) cases.push_back(i);
  const std::size_t step = std::max<std::size_t>(1, cases.size() / most_dots);
  for (std::size_t i = 0; i < cases.size(); i += step) drawn.push_back(cases[i]);
  return drawn;
}

std::string dot_of(const CaseTable& table, std::size_t number, double x, double y) {
  return fmt::format(
      "<a href=\"#case-{}\"><circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\"><title>{}</title></circle></a>",
      number, table.passed(number) ? "passed" : "failed", x, y, title_of(table, number));
}

std::string case_articles(const Campaign& campaign, const CaseTable& table) {
  std::string text = "<div class=\"cases\">\n";
  for (const bool passed : {true, false})
    for (const std::size_t number : drawn_cases(table, passed)) text += article_of(campaign, table, number);
  return text + "</div>\n";
}

}  // namespace rehearse
