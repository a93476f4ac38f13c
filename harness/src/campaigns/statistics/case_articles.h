// The cases to which the dots of a campaign's page lead. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <cstddef>
#include <string>
#include <vector>

#include "case_table.h"

namespace rehearse {

/// The cases that are drawn as dots: of each kind, passed or not, all, or of more than 2000 some at equal distances.
std::vector<std::size_t> drawn_cases(const CaseTable& table, bool passed);

/// A dot that leads to the article of its case. x, y: in the picture's units.
std::string dot_of(const CaseTable& table, std::size_t number, double x, double y);

/// An article for each drawn case: its verdict, its reason, its values, the command that records it again, and its
/// recording if it is kept. A page shows the article to which a dot has led, and no other.
std::string case_articles(const Campaign& campaign, const CaseTable& table);

}  // namespace rehearse
