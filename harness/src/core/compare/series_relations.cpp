#include "series_relations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace rehearse {
namespace {

using Values = std::vector<double>;
using Kind = SeriesRelation::Kind;

constexpr double accuracy = 1e-6;           // of a series' range
constexpr std::ptrdiff_t few_changes = 10;  // up to so many a relation may be a coincidence
constexpr int longest_delay = 3;            // [values]
constexpr std::size_t named = 3;            // series of a relation that a sentence names

/// What of a series decides about relations.
struct Profile {
  double tolerance = 0.0;
  std::size_t peak = 0;                               // where the present value is farthest from its first
  bool is_excited = false;                            // both runs change often enough
  std::optional<std::int64_t> first_difference = {};  // tick
};

std::ptrdiff_t changes(const Values& values) {
  std::ptrdiff_t count = 0;
  for (std::size_t i = 1; i < values.size(); ++i) count += values[i] != values[i - 1] ? 1 : 0;
  return count;
}

bool are_finite(const Values& values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

Profile profile_of(const PairedSeries& series) {
  Profile profile;
  if (series.ticks.empty()) return profile;
  const auto [least, greatest] = std::minmax_element(series.recorded.begin(), series.recorded.end());
  profile.tolerance = accuracy * (*greatest - *least);
  for (std::size_t i = 0; i < series.ticks.size(); ++i) {
    const double now = series.present[i];
    if (!(std::abs(now - series.recorded[i]) <= profile.tolerance) && !profile.first_difference)
      profile.first_difference = series.ticks[i];
    if (std::abs(now - series.present[0]) > std::abs(series.present[profile.peak] - series.present[0]))
      profile.peak = i;
  }
  profile.is_excited = are_finite(series.recorded) && are_finite(series.present) &&
                       std::min(changes(series.recorded), changes(series.present)) >= few_changes;
  return profile;
}

/// True if values[i] is factor * others[i - steps] + added for all i that have both. The place that is probably
/// different is examined first.
bool agree(const Values& values, const Values& others, int steps, double factor, double added, double tolerance,
           std::size_t probe) {
  const auto end = static_cast<std::ptrdiff_t>(values.size());
  const std::ptrdiff_t begin = std::max(0, steps), last = std::min<std::ptrdiff_t>(end, end + steps);
  const auto agrees_at = [&](std::ptrdiff_t i) {
    return std::abs(values[static_cast<std::size_t>(i)] -
                    (factor * others[static_cast<std::size_t>(i - steps)] + added)) <= tolerance;
  };
  const auto place = static_cast<std::ptrdiff_t>(probe);
  if (place >= begin && place < last && !agrees_at(place)) return false;
  for (std::ptrdiff_t i = begin; i < last; ++i)
    if (!agrees_at(i)) return false;
  return true;
}

/// Finds the relations of one series after the other.
class RelationFinder {
 public:
  explicit RelationFinder(const std::vector<PairedSeries>& all) : all_(all) {
    for (const PairedSeries& series : all) profiles_.push_back(profile_of(series));
  }

  const Profile& profile(std::size_t i) const { return profiles_[i]; }

  /// None if there is no relation, or more than one.
  std::optional<SeriesRelation> relation_of(std::size_t i) const {
    if (!profiles_[i].is_excited) return std::nullopt;
    std::vector<SeriesRelation> found;
    find_others(i, found);
    find_own(i, found);
    if (found.empty()) find_stale(i, found);
    return found.size() == 1 ? std::optional(found[0]) : std::nullopt;
  }

 private:
  bool comparable(std::size_t i, std::size_t j) const {
    return i != j && profiles_[j].is_excited && all_[i].ticks == all_[j].ticks;
  }

  void find_others(std::size_t i, std::vector<SeriesRelation>& found) const {
    const Profile& own = profiles_[i];
    for (std::size_t j = 0; j < all_.size(); ++j) {
      if (!comparable(i, j)) continue;
      const double difference = all_[i].present[own.peak] - all_[j].recorded[own.peak];
      const double added = std::abs(difference) <= own.tolerance ? 0.0 : difference;
      if (agree(all_[i].present, all_[j].recorded, 0, 1.0, added, own.tolerance, 0))
        found.push_back({Kind::order, i, j, added});
    }
  }

  void find_own(std::size_t i, std::vector<SeriesRelation>& found) const {
    const Values &present = all_[i].present, &recorded = all_[i].recorded;
    const Profile& own = profiles_[i];
    const auto largest =
        std::ranges::max_element(recorded, [](double a, double b) { return std::abs(a) < std::abs(b); });
    const double factor = present[static_cast<std::size_t>(largest - recorded.begin())] / *largest;
    const double range = std::max(1.0, std::abs(factor)) * own.tolerance;
    if (factor != 0.0 && agree(present, recorded, 0, factor, 0.0, range, own.peak))
      found.push_back({Kind::scale, i, i, factor});
    const double added = present[own.peak] - recorded[own.peak];
    if (agree(present, recorded, 0, 1.0, added, own.tolerance, 0)) found.push_back({Kind::offset, i, i, added});
    for (int steps = -longest_delay; steps <= longest_delay; ++steps)
      if (steps != 0 && agree(present, recorded, steps, 1.0, 0.0, own.tolerance, own.peak))
        found.push_back({Kind::delay, i, i, 0.0, steps});
  }

  /// In each of the two runs the series repeats another one of the same run, but with another delay.
  void find_stale(std::size_t i, std::vector<SeriesRelation>& found) const {
    for (std::size_t j = 0; j < all_.size(); ++j) {
      if (!comparable(i, j)) continue;
      const auto then = delay_after(all_[i].recorded, all_[j].recorded, profiles_[i]);
      const auto now = then ? delay_after(all_[i].present, all_[j].present, profiles_[i]) : std::nullopt;
      if (now && *now != *then) found.push_back({Kind::stale, i, j, 0.0, *now, *then});
    }
  }

  static std::optional<int> delay_after(const Values& values, const Values& others, const Profile& profile) {
    for (int steps = 0; steps <= longest_delay; ++steps)
      if (agree(values, others, steps, 1.0, 0.0, profile.tolerance, profile.peak)) return steps;
    return std::nullopt;
  }

  const std::vector<PairedSeries>& all_;
  std::vector<Profile> profiles_;
};

std::string values_text(int steps) { return fmt::format("{} value{}", steps, steps == 1 ? "" : "s"); }

/// Relations of one kind, of which the first stands for all.
class RelationText {
 public:
  RelationText(std::vector<SeriesRelation> relations, const std::vector<PairedSeries>& series, bool is_whole)
      : relations_(std::move(relations)), series_(series), is_whole_(is_whole) {}

  std::string text() const {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < std::min(named, relations_.size()); ++i) parts.push_back(part(relations_[i]));
    const std::size_t others = relations_.size() - parts.size();
    return fmt::format("{}: {}{}{}", conclusion(), fmt::join(parts, ", "),
                       others > 0 ? fmt::format(", and {} more likewise", others) : "", evidence());
  }

 private:
  const std::string& name(std::size_t i) const { return series_[i].name; }

  static std::string added(const SeriesRelation& relation) {
    if (relation.number == 0.0) return {};
    return fmt::format(" {} {:.6g}", relation.number < 0.0 ? "-" : "+", std::abs(relation.number));
  }

  std::string part(const SeriesRelation& relation) const {
    const std::string& own = name(relation.series);
    switch (relation.kind) {
      case Kind::order:
        return fmt::format("{} has the recorded values of {}{}", own, name(relation.other), added(relation));
      case Kind::scale: return fmt::format("{} is {:.6g} times the recorded one", own, relation.number);
      case Kind::offset: return fmt::format("{} is the recorded one{}", own, added(relation));
      case Kind::delay:
        return fmt::format("{} is the recorded one of {} {}", own, values_text(std::abs(relation.steps)),
                           relation.steps > 0 ? "before" : "after");
      case Kind::stale:
        return fmt::format("{} is {} of {} before, in the recording of {} before", own, name(relation.other),
                           values_text(relation.steps), values_text(relation.recorded_steps));
    }
    return {};
  }

  std::string_view conclusion() const {
    switch (relations_[0].kind) {
      case Kind::order: return is_permutation() ? "the order differs" : "another series is taken";
      case Kind::scale: return "the scale differs";
      case Kind::offset: return "the zero differs";
      case Kind::delay: return relations_[0].steps > 0 ? "it is late" : "it is early";
      case Kind::stale: return relations_[0].steps > relations_[0].recorded_steps ? "it is stale" : "it is early";
    }
    return {};
  }

  bool is_permutation() const {
    std::set<std::size_t> from, to;
    for (const SeriesRelation& relation : relations_) {
      from.insert(relation.other);
      to.insert(relation.series);
    }
    return from == to;
  }

  std::string evidence() const {
    return fmt::format(", in {} {} values", is_whole_ ? "all" : "the first",
                       series_[relations_[0].series].ticks.size());
  }

  std::vector<SeriesRelation> relations_;
  const std::vector<PairedSeries>& series_;
  const bool is_whole_;
};

}  // namespace

std::vector<SeriesRelation> find_relations(const std::vector<PairedSeries>& series) {
  constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
  const RelationFinder finder(series);
  std::vector<SeriesRelation> found;
  std::int64_t first_known = never, first_unknown = never;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const auto first = finder.profile(i).first_difference;
    if (!first) continue;
    const auto relation = finder.relation_of(i);
    if (relation) found.push_back(*relation);
    std::int64_t& earliest = relation ? first_known : first_unknown;
    earliest = std::min(earliest, *first);
  }
  if (first_unknown < first_known) found.clear();
  return found;
}

std::string to_string(const std::vector<SeriesRelation>& relations, const std::vector<PairedSeries>& series,
                      bool is_whole) {
  std::vector<std::string> parts;
  for (const Kind kind : {Kind::order, Kind::scale, Kind::offset, Kind::delay, Kind::stale}) {
    std::vector<SeriesRelation> of_kind;
    std::ranges::copy_if(relations, std::back_inserter(of_kind),
                         [&](const SeriesRelation& relation) { return relation.kind == kind; });
    if (!of_kind.empty()) parts.push_back(RelationText(std::move(of_kind), series, is_whole).text());
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace rehearse
