#include "importance.h"

#include <rehearse/campaign_report.h>

#include <cmath>
#include <string>
#include <vector>

namespace rehearse {
namespace {

/// The index on a column, over the cases with a result that have a number there.
std::optional<FirstOrderIndex> index_of(const CaseTable& table, std::size_t parameter,
                                        const std::vector<double>& column) {
  std::vector<double> inputs, outputs;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!table.has(i) || !std::isfinite(column[i])) continue;
    inputs.push_back(table.values[parameter][i]);
    outputs.push_back(column[i]);
  }
  const std::size_t words = table.words[parameter].size();
  if (words * words > inputs.size()) return std::nullopt;  // words can't be put into parts
  return first_order_index(inputs, outputs);
}

}  // namespace

std::optional<FirstOrderIndex> importance_of_passing(const CaseTable& table, std::size_t parameter) {
  std::vector<double> passing(table.size());
  for (std::size_t i = 0; i < table.size(); ++i) passing[i] = table.has(i) && table.passed(i) ? 1.0 : 0.0;
  return index_of(table, parameter, passing);
}

std::optional<IndexOfMargin> importance_of_margin(const Campaign& campaign, const CaseTable& table,
                                                  std::size_t parameter) {
  std::optional<IndexOfMargin> largest;
  for (std::size_t e = 0; e < table.margins.size(); ++e) {
    const auto found = index_of(table, parameter, table.margins[e]);
    if (found && (!largest || found->share > largest->index.share))
      largest = IndexOfMargin{campaign.expectations()[e], *found};
  }
  return largest;
}

}  // namespace rehearse
