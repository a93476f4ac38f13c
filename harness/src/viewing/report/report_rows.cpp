#include "report_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string_view>

#include "core/kinds/channel_name.h"
#include "core/trace/trace_windows.h"

namespace rehearse {
namespace {

// How the chosen numbers are divided.
constexpr double share_of_span = 0.25;      // around the centre
constexpr double share_of_steps = 0.35;     // in equal steps
constexpr double share_of_extremes = 0.40;  // the lowest and highest values

constexpr double most_cells_of_channel = 3e6;
constexpr double cells_in_group = 2e6;  // a group ends with the channel that reaches this number
constexpr std::size_t runs = 2;
constexpr std::uint64_t before_all = ~std::uint64_t{0};

/// For each column of a channel the one of another channel with its name and kind.
std::vector<std::size_t> columns_in(const TraceChannel& channel, const TraceChannel& other) {
  std::map<std::string_view, std::size_t> known;
  for (std::size_t i = 0; i < other.columns.size(); ++i) known.emplace(other.columns[i].element, i);
  std::vector<std::size_t> places(channel.columns.size(), ShownChannel::no_column);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto found = known.find(channel.columns[i].element);
    if (found != known.end() && other.columns[found->second].kind == channel.columns[i].kind) places[i] = found->second;
  }
  return places;
}

/// Counts the differing values of messages of equal times, and calls `on_first` with both messages that have the first
/// one of a column.
void count_differing(const TraceChannel& actual, const TraceChannel& golden, ShownChannel& shown,
                     const std::function<void(std::size_t, std::size_t)>& on_first) {
  std::size_t a = 0, g = 0;
  while (a < actual.rows() && g < golden.rows()) {
    if (actual.times[a] != golden.times[g]) {
      ++(actual.times[a] < golden.times[g] ? a : g);
      continue;
    }
    if (actual.hashes[a] != golden.hashes[g]) {
      bool is_first = false;
      for (std::size_t i = 0; i < shown.golden_columns.size(); ++i) {
        const std::size_t other = shown.golden_columns[i];
        if (other == ShownChannel::no_column || actual.bits(a, i) == golden.bits(g, other)) continue;
        is_first = is_first || shown.differing[i] == 0;
        ++shown.differing[i];
      }
      if (is_first) on_first(a, g);
    }
    ++a;
    ++g;
  }
}

}  // namespace

/// The state of reading a group of pairs.
struct ShownRows::Reading {
  std::vector<std::array<std::uint64_t, runs>> last_step;  // by index in pairs_: step of the last chosen message
  std::vector<std::array<std::size_t, runs>> next_time;    // by index in pairs_: index of the next of Choice::times
};

/// Finds the messages of a run with the lowest and highest value of each series in each stretch of time.
class ShownRows::ExtremesFinder {
 public:
  /// `choices` by place of the channel in the run; null: the channel isn't wanted.
  explicit ExtremesFinder(std::vector<Choice*> choices) : choices_(std::move(choices)), states_(choices_.size()) {}

  void take(const Trace& piece) {
    for (std::size_t place = 0; place < choices_.size(); ++place)
      if (choices_[place]) take(piece.channels()[place], *choices_[place], states_[place]);
  }
  void finish() {
    for (std::size_t place = 0; place < choices_.size(); ++place)
      if (choices_[place]) end_stretch(*choices_[place], states_[place]);
  }

 private:
  struct Extremes {
    ValueRange range;
    std::uint64_t low = 0, high = 0;  // times [ns]
  };
  struct State {
    std::uint64_t stretch = before_all;
    std::vector<Extremes> columns = {};
  };

  static void end_stretch(Choice& choice, State& state) {
    for (const Extremes& extremes : state.columns)
      if (!extremes.range.empty()) choice.times.insert(choice.times.end(), {extremes.low, extremes.high});
    state.columns.clear();
  }
  static void take(const TraceChannel& table, Choice& choice, State& state) {
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const std::uint64_t time = table.times[row];
      if (const std::uint64_t stretch = time / choice.stretch; stretch != state.stretch) {
        end_stretch(choice, state);
        state.stretch = stretch;
      }
      state.columns.resize(table.columns.size());
      for (std::size_t i = 0; i < state.columns.size(); ++i) {
        Extremes& extremes = state.columns[i];
        const double value = table.number(row, i);
        if (!std::isfinite(value)) continue;
        if (value < extremes.range.low) extremes.low = time;
        if (value > extremes.range.high) extremes.high = time;
        extremes.range.take(value);
      }
    }
  }

  const std::vector<Choice*> choices_;
  std::vector<State> states_;
};

ShownRows::ShownRows(const ReportedRun& actual, const ReportedRun* golden, std::vector<ChannelPair> pairs,
                     RowFocus focus, std::uint64_t most_cells)
    : actual_(actual), golden_(golden), pairs_(std::move(pairs)), focus_(std::move(focus)), choices_(pairs_.size()) {
  first_time_ = before_all;
  std::uint64_t cells = 0;
  for (const ChannelPair& pair : pairs_) {
    cells += cells_of(pair);
    for (std::size_t i = 0; i < runs; ++i) {
      const auto place = read_place(pair, i);
      if (!place) continue;
      first_time_ = std::min(first_time_, run(i)->channels[*place].first_time);
      last_time_ = std::max(last_time_, run(i)->channels[*place].last_time);
    }
  }
  if (first_time_ >= last_time_) return;
  const double share = static_cast<double>(most_cells) / static_cast<double>(cells);
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const double own = most_cells_of_channel / static_cast<double>(std::max<std::uint64_t>(1, cells_of(pairs_[k])));
    plan(k, std::min(share, own));
    is_limited_ = is_limited_ || (share < 1.0 && share < own);
  }
  if (is_thinned() && focus_.centre)
    half_span_ = static_cast<std::uint64_t>(0.5 * share_of_span * smallest_share_ *
                                            static_cast<double>(last_time_ - first_time_));
}

/// True if both runs have the same numbers: the golden's needn't be read. Pictures have places in their file.
bool ShownRows::is_equal(const ChannelPair& pair) const {
  if (!pair.actual || !pair.golden) return false;
  const TraceChannel &actual = actual_.trace.channels()[*pair.actual],
                     &golden = golden_->trace.channels()[*pair.golden];
  return !actual.columns.empty() && actual.columns.size() == golden.columns.size() && actual.type == golden.type &&
         actual_.channels[*pair.actual].same_messages(golden_->channels[*pair.golden]);
}

/// The numbers of a pair, and of each message its time and two words for its place in the file.
std::uint64_t ShownRows::cells_of(const ChannelPair& pair) const {
  std::uint64_t cells = 0;
  for (std::size_t i = 0; i < runs; ++i)
    if (const auto place = read_place(pair, i))
      cells += run(i)->channels[*place].messages * (3 + run(i)->trace.channels()[*place].columns.size());
  return cells;
}

void ShownRows::plan(std::size_t pair, double share) {
  Choice& choice = choices_[pair];
  std::uint64_t messages = 0;
  std::size_t columns = 0, extremes = 0;  // of both runs
  for (std::size_t i = 0; i < runs; ++i) {
    const auto place = read_place(pairs_[pair], i);
    if (!place) continue;
    messages = std::max(messages, run(i)->channels[*place].messages);
    columns = run(i)->trace.channels()[*place].columns.size();
    extremes += 2 * columns;
  }
  if (share >= 1.0 || columns == 0 || messages == 0) return;  // all pictures are passed on
  choice.share = share;
  smallest_share_ = std::min(smallest_share_, share);
  const auto length = static_cast<double>(last_time_ - first_time_);
  const double chosen = share * static_cast<double>(messages);
  choice.step = static_cast<std::uint64_t>(length / std::max(1.0, share_of_steps * chosen)) + 1;
  const double stretches = share_of_extremes * chosen / static_cast<double>(extremes);
  if (stretches >= 0.5) choice.stretch = static_cast<std::uint64_t>(length / std::max(1.0, stretches)) + 1;
}

Result<void> ShownRows::find_extremes() {
  for (std::size_t i = 0; i < runs; ++i) {
    if (!run(i)) continue;
    std::vector<Choice*> wanted(run(i)->trace.channels().size(), nullptr);
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      if (const auto place = read_place(pairs_[k], i); place && choices_[k].stretch > 0) wanted[*place] = &choices_[k];
    ExtremesFinder finder(std::move(wanted));
    REHEARSE_TRY(load_pieces(
        run(i)->file, nullptr, [&finder](const Trace& piece) { finder.take(piece); }, Trace::usual_piece_size,
        PieceOrder::of_time, Trace::Damage::tolerate));
    finder.finish();
  }
  for (Choice& choice : choices_) {
    std::ranges::sort(choice.times);
    choice.times.erase(std::unique(choice.times.begin(), choice.times.end()), choice.times.end());
    choice.times.shrink_to_fit();
  }
  return {};
}

bool ShownRows::is_focused(std::uint64_t time) const {
  const auto distance = [time](std::uint64_t other) { return time > other ? time - other : other - time; };
  if (focus_.centre && distance(*focus_.centre) <= half_span_) return true;
  const auto mark = std::lower_bound(focus_.marks.begin(), focus_.marks.end(), time - std::min(time, focus_.around));
  return mark != focus_.marks.end() && distance(*mark) <= focus_.around;
}

void ShownRows::choose(const TraceChannel& table, std::size_t pair, std::size_t index, Reading& reading,
                       std::vector<std::size_t>& chosen) const {
  const Choice& choice = choices_[pair];
  const bool takes_all = choice.share >= 1.0;
  const ChannelSummary& summary = run(index)->channels[*read_place(pairs_[pair], index)];
  std::uint64_t& last_step = reading.last_step[pair][index];
  std::size_t& next = reading.next_time[pair][index];
  for (std::size_t message = 0; message < table.messages(); ++message) {
    const std::uint64_t time = table.times[message];
    while (next < choice.times.size() && choice.times[next] < time) ++next;
    const bool is_extreme = next < choice.times.size() && choice.times[next] == time;
    const std::uint64_t step = time / choice.step;
    if (!takes_all && !is_extreme && step == last_step && time != summary.last_time && !is_focused(time)) continue;
    chosen.push_back(message);
    last_step = step;
  }
}

/// Reads a group of pairs, both runs in step.
void ShownRows::read(std::span<const std::size_t> group, const std::function<void(const ShownChannel&)>& take) const {
  std::vector<ShownChannel> shown(group.size());
  std::array<std::vector<std::size_t>, runs> places;
  for (std::size_t k = 0; k < group.size(); ++k) {
    shown[k].pair = pairs_[group[k]];
    for (std::size_t i = 0; i < runs; ++i) {
      const auto place = place_in(shown[k].pair, i);
      if (!place) continue;
      TraceChannel& table = i == 0 ? shown[k].actual : shown[k].golden;
      table = run(i)->trace.channels()[*place];
      table.earlier = 0;
      if (read_place(shown[k].pair, i)) places[i].push_back(*place);
    }
    shown[k].golden_columns = columns_in(shown[k].actual, shown[k].golden);
    shown[k].differing.resize(shown[k].golden_columns.size());
  }
  std::array<std::unique_ptr<TraceWindows>, runs> windows;
  for (std::size_t i = 0; i < runs; ++i)
    if (!places[i].empty()) windows[i] = std::make_unique<TraceWindows>(run(i)->trace, places[i]);
  Reading reading{std::vector<std::array<std::uint64_t, runs>>(pairs_.size(), {before_all, before_all}),
                  std::vector<std::array<std::size_t, runs>>(pairs_.size(), {0, 0})};
  std::uint64_t cells = 1;
  for (const std::size_t pair : group) cells += cells_of(pairs_[pair]);
  const std::uint64_t pieces = 1 + cells * sizeof(std::uint64_t) / Trace::usual_piece_size;
  const std::uint64_t span = (last_time_ - std::min(first_time_, last_time_)) / pieces + 1;
  for (;;) {
    std::optional<std::uint64_t> begin;
    for (const auto& of_run : windows)
      if (const auto next = of_run ? of_run->next_time() : std::nullopt; next && (!begin || *next < *begin))
        begin = next;
    if (!begin) break;
    for (const auto& of_run : windows)
      if (of_run) of_run->move(*begin, *begin + span);
    for (std::size_t k = 0; k < group.size(); ++k) {
      std::array<std::vector<std::size_t>, runs> chosen;
      std::array<const TraceChannel*, runs> tables{};
      for (std::size_t i = 0; i < runs; ++i) {
        const auto place = read_place(shown[k].pair, i);
        if (!place) continue;
        tables[i] = &windows[i]->window().channels()[*place];
        choose(*tables[i], group[k], i, reading, chosen[i]);
      }
      if (tables[0] && tables[1])
        count_differing(*tables[0], *tables[1], shown[k], [&chosen](std::size_t a, std::size_t g) {
          chosen[0].push_back(a);
          chosen[1].push_back(g);
        });
      for (std::size_t i = 0; i < runs; ++i) {
        if (!tables[i]) continue;
        std::ranges::sort(chosen[i]);
        chosen[i].erase(std::unique(chosen[i].begin(), chosen[i].end()), chosen[i].end());
        append_messages(i == 0 ? shown[k].actual : shown[k].golden, *tables[i], chosen[i]);
      }
    }
  }
  for (ShownChannel& channel : shown) {
    if (is_equal(channel.pair)) {
      channel.golden.times = channel.actual.times;
      channel.golden.cells = channel.actual.cells;
    }
    take(channel);
    channel = {};
  }
}

Result<void> ShownRows::for_each(const std::function<void(const ShownChannel&)>& take) {
  if (is_thinned()) REHEARSE_TRY(find_extremes());
  std::vector<std::size_t> group;
  double cells = 0.0;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    group.push_back(k);
    cells += choices_[k].share * static_cast<double>(cells_of(pairs_[k]));
    if (cells < cells_in_group && k + 1 < pairs_.size()) continue;
    read(group, take);
    group.clear();
    cells = 0.0;
  }
  return {};
}

}  // namespace rehearse
