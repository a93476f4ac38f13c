// Comparison: two traces of what should be the same run, value by value; what differs, where first, and by how much.
//
// Three answers at once. `equal`: every number, picture and event has the same bits. `within`: everything passes its
// tolerance (scenario.h). And the places: the first beyond tolerance, the first where bits differ, the worst.
//
// Messages of a channel are matched by their time, tables by the names of their elements. What one trace has and the
// other lacks is a finding with its place: a tick, a body, a controller, a device is one finding, whatever it takes
// with it. The hashes in /tick are no quantities: they say whether bits are equal and from which tick on they aren't,
// and fail nothing. Integers and booleans are exact. NaN equals NaN of the same tick; -0 and 0 are other bits and the
// same number. An orientation is compared by the angle between the two, 2 atan2(|v|, |w|) of q_golden^-1 q_actual = (v,
// w), so q and -q are the same, and apart from that by its norm; an angle whose channel says `wrap:<element>` in its
// metadata is compared modulo one turn. Our recordings say so of no joint: they count turns, and a robot that has made
// one more is somewhere else.
//
// Events are compared as sequences, each kind and owner for itself: contacts that begin and end (/contacts), joints at
// the limits that the simulation keeps them to (`limits:` of a body's /joints), control() that returns false (/tick),
// and messages (/events). The golden's and the run's are put beside each other in order first; what is missing, extra
// or in another order is a finding, and so is one that comes more ticks early or late than is allowed. A contact or a
// limit may be off by one tick: in which of two steps a threshold is crossed, a last bit decides; and what lasts no
// longer may come or go. All else has to be in the same tick. A rule with `ticks` changes this, and where it lets an
// event pass that is off, the numbers of the bodies concerned are not judged from the one tick to the other.
//
// "First" is by tick; within one tick in the order in which things cause each other there: the state of the bodies,
// what sensors measure of it, the pictures that arrive, the inputs that are copied from these, the commands made from
// the inputs.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// One place where two runs differ, and by how much.
struct Divergence {
  std::int64_t tick = 0;
  double time = 0.0;      // of the tick [s]
  std::string channel;    // topic
  std::string element;    // within the channel's messages: RLEG_KNEE/u; empty: the message as a whole
  double expected = 0.0;  // in the recording or golden
  double actual = 0.0;
  double difference = 0.0;  // |actual - expected|, by angle where it is one; 0 if both are NaN, NaN if one is
  std::uint64_t ulps = 0;   // representable numbers between them; the largest value if either is NaN
  double tolerance = 0.0;   // that it should have kept; 0: bit for bit
  std::string unit;         // may be empty
  std::string note;         // if it isn't a matter of two numbers: "missing", "120 pixels differ, ..."
  Stage stage = Stage::controller;
};

/// Differences of a run from another one, counted in the order in which they are found.
struct Differences {
  std::int64_t values = 0;  // numbers compared
  std::int64_t values_different = 0;
  std::optional<Divergence> first;
  std::optional<Divergence> worst;   // by absolute difference
  std::optional<Divergence> beyond;  // the first beyond its tolerance, or with a note

  void add(Divergence found);
};

/// Sets expected, actual, difference, ulps and unit: those that two numbers determine.
void put_numbers(Divergence& divergence, double expected, double actual, std::string_view unit = {});

/// The difference relative to what was expected; NaN where that means nothing: angles between orientations, angles
/// modulo a turn, what isn't a matter of two numbers.
double relative_difference(const Divergence& divergence);

/// How many times its tolerance a difference is; infinity where none is allowed.
double times_tolerance(double difference, double tolerance);

/// One sentence: tick, time, channel, element, expected, actual, absolute and relative difference, ULPs, times the
/// tolerance, and stage.
std::string to_string(const Divergence& divergence);

/// An object with all members, and relative and times_tolerance. expected, actual, difference, relative, ulps,
/// tolerance and times_tolerance are null where it isn't a matter of two numbers; NaN and infinities are strings.
std::string to_json(const Divergence& divergence);

/// How many steps from one double to the next lead from a to b; 0 for equal bits and for 0 and -0. NaN with anything
/// but the same bits: the largest value.
std::uint64_t ulps_between(double a, double b);

/// Same bits.
bool identical(double a, double b);

/// How far one series of numbers strays from its golden.
struct SeriesComparison {
  std::string element;     // of an orientation: without its axis
  std::string unit;        // an orientation's is rad
  double largest = 0.0;    // difference; by angle where it is one; NaN if a number met one that isn't any
  double tolerance = 0.0;  // in force
};

/// What became of one channel, or of what several channels lack together.
struct ChannelComparison {
  std::string channel;  // topic; of several the first
  Stage stage = Stage::physics;
  int channels = 1;                     // that it stands for: a body that is missing takes more than one with it
  std::string group;                    // how the topics of these begin, if they are more than one: "/SR1/LeftCamera/"
  bool of_events = false;               // it counts what happened on the channel, not its values
  std::int64_t values = 0;              // compared: numbers, pictures, or events
  std::int64_t differing = 0;           // of them, not the same bits
  std::int64_t in_noise = 0;            // of the differing, not above the noise floor
  std::int64_t beyond = 0;              // of the differing, beyond tolerance
  std::int64_t blanked = 0;             // of the differing, not judged: an event nearby is off by what it may be
  std::int64_t missing = 0;             // messages of the golden that the other trace hasn't, in ticks that it has
  std::int64_t extra = 0;               // messages that the golden hasn't, likewise
  std::optional<Divergence> first;      // beyond tolerance, or missing
  std::optional<Divergence> first_bit;  // in any bit, or missing
  std::optional<Divergence> worst;      // by times its tolerance, then by difference
  /// All but integers. Of pictures: the largest difference of a colour, "of 255", and the largest share "of pixels" that
  /// differ by more than is allowed to each.
  std::vector<SeriesComparison> series;
};

/// An event that isn't where the golden has it.
struct EventDifference {
  std::string event;                     // name of its sequence, as rules know it: contacts/Box/Box/Floor/Floor
  std::string what;                      // "begins", "ends"
  std::optional<std::int64_t> expected;  // tick in the golden; none: it is extra
  std::optional<std::int64_t> actual;    // tick in the run; none: it is missing
  bool beyond = false;                   // what is allowed
};

/// How well two runs agree, by what differs most.
enum class Agreement {
  equal,     // bit for bit
  in_noise,  // nothing is above its noise floor
  within,    // tolerance
  beyond,    // tolerance, or something is missing or extra
};

/// "equal", "in noise", "within" or "beyond".
std::string_view to_string(Agreement agreement);

struct Comparison {
  bool equal = false;                       // bit for bit
  bool within = false;                      // nothing beyond tolerance, nothing missing, nothing extra; true if equal
  Agreement agreement = Agreement::equal;
  std::int64_t ticks = 0;                   // compared
  std::int64_t values = 0;                  // numbers, pictures and events compared
  std::int64_t pictures = 0;                // of these
  std::int64_t events = 0;                  // of these
  std::int64_t differing = 0;               // of the values, not the same bits
  std::int64_t in_noise = 0;                // of the differing, not above the noise floor
  std::int64_t beyond = 0;                  // of the differing, beyond tolerance
  std::int64_t blanked = 0;                 // of the differing, not judged
  std::optional<Divergence> first;          // beyond tolerance, or missing
  std::optional<Divergence> first_bit;      // in any bit, hashes included
  /// By times its tolerance; of what has none only if nothing else is beyond.
  std::optional<Divergence> worst;
  std::string explanation;  // what else changed that may have caused the first: "the renderer"; or empty
  std::vector<ChannelComparison> channels;  // all that differ in any way, by their first_bit
  std::vector<ChannelComparison> same;      // all others that were compared
  std::vector<std::string> equal_channels;  // topics of all that don't, in the golden's order
  std::vector<EventDifference> event_differences;  // by tick, the first thousand
  std::vector<std::string> changed_files;          // attachments that are not what they were in the golden
  bool same_arithmetic = true;                     // versions and pins that bits depend on are the golden's
  /// All that the traces say they come from is the same: scenario, models, controllers, the very same programs. Then
  /// their bits have to be. False if one of them doesn't say.
  bool same_origin = false;
  /// Nothing differs but lines that controllers write, which no rule asks to compare.
  bool words_alone = false;
  /// What explains a difference or makes one likely: another scenario, model, controller, library. Sentences.
  std::vector<std::string> remarks;
  /// What whoever asked will want to mend: rules that match nothing.
  Diagnostics warnings;
};

/// Numbers or a picture of the same time that haven't the same bits.
struct DifferingValue {
  const TraceChannel& channel;            // of the golden
  std::size_t message = 0;                // of that channel
  std::vector<std::size_t> columns = {};  // one, or the four of an orientation; none: a picture
  bool beyond = false;                    // its tolerance
  std::int64_t pixels = 0;                // of a picture: that differ by more than is allowed to each
};

/// What of two traces is compared.
struct CompareOptions {
  /// Values that these parts of the loop make; the channels of the others are left out altogether. Empty: all.
  std::vector<Stage> stages;
  /// Messages up to this time, inclusive [s]; none: as long as both runs go. A run that is shorter is a finding all the
  /// same, unless both reach this time.
  std::optional<double> until;
  /// Noise floors by series, in its unit, of an orientation's element its angle [rad]: what the run differs by under
  /// perturbations that mean nothing. A difference up to it is counted as noise; what passes or fails is not changed.
  std::map<std::string, double, std::less<>> noise_floors;
  /// Told of each value that differs, hashes apart; null: nobody wants to know. A value may come twice.
  std::function<void(const DifferingValue&)> on_difference;

  bool takes(Stage stage) const;
};

Comparison compare(const Trace& golden, const Trace& actual, const std::vector<ToleranceRule>& rules,
                   const CompareOptions& options = {});

/// The same of two recordings that need not fit into the memory: each is read once, and what differs once more, in
/// windows of time whose numbers take about `window_size` bytes. Fails if one of them can't be read.
Result<Comparison> compare(const std::filesystem::path& golden, const std::filesystem::path& actual,
                           const std::vector<ToleranceRule>& rules, const CompareOptions& options = {},
                           std::size_t window_size = Trace::usual_piece_size);

/// Fails if the trace is of a version that this program doesn't know: what is in it may mean anything. A comparison with
/// it says so, and nothing else.
Result<void> check_version(const Trace& trace);

/// The tolerances of the scenario that the trace carries; none if it carries none.
Result<std::vector<ToleranceRule>> tolerances_of(const Trace& trace);

/// One sentence, without a full stop.
std::string verdict(const Comparison& comparison);

/// The same of a comparison up to a horizon [s], which it names: "up to 2 s equal bit for bit: ...".
std::string verdict(const Comparison& comparison, std::optional<double> until);

/// What differs, alike channels grouped, with counts and the worst of each; the worst of all; what is equal bit for
/// bit; remarks and warnings. At most sixteen lines beside warnings, each with its newline and, unless names are long,
/// at most 120 characters. Empty if the traces are equal and there are no warnings.
std::string table(const Comparison& comparison);

/// An object with the same content: verdict, equal, within, agreement, first, first_bit, worst (null, or objects as
/// to_json(Divergence)), explanation, counts, channels, equal_channels, events, remarks, warnings.
std::string to_json(const Comparison& comparison);

// Pictures of what differs between pictures: expected, actual and difference side by side, for a person to look at.

/// For each camera channel with a picture beyond its tolerance, its first such picture as PNG: the golden's, the
/// other's, and the difference: in red what is beyond, in yellow what differs within tolerance, on a dimmed picture of
/// the golden's. Distances are shown as grey, from white where they are least to black at the greatest; blue is where
/// nothing was found. The files are named like `actual`, then by channel: "Run.SR1.LeftCamera.image.png" beside
/// "Run.mcap"; older ones of that name are removed first. Returns what was written.
Result<std::vector<std::filesystem::path>> write_picture_differences(const Trace& golden, const Trace& actual,
                                                                     const Comparison& comparison,
                                                                     const std::vector<ToleranceRule>& rules,
                                                                     const std::filesystem::path& beside);

/// "expected, actual and difference: FILE", a line each, each after a newline; or why they couldn't be written.
std::string picture_lines(const Result<std::vector<std::filesystem::path>>& written);

/// Removes what write_picture_differences() wrote beside that recording.
void remove_picture_differences(const std::filesystem::path& beside);

// Small pictures of series in a terminal's characters: a golden and a run over time, and where they part.

/// A series to draw. Samples that aren't finite are left out.
struct Curve {
  std::vector<double> times;  // [s], ascending
  std::vector<double> values;
};

struct PlotSize {
  std::size_t width = 78;  // [characters], labels included
  std::size_t height = 7;  // [lines] of the curves; two more are the axis of time
};

/// Both curves over one axis of time, with a mark below the time of their first difference. Each column shows the range
/// of its samples: ▒ where both are, ░ where only the golden is, █ where only the run is. Lines, each with its newline;
/// one that says so if there is nothing to draw.
std::string plot(const Curve& golden, const Curve& run, std::optional<double> mark, PlotSize size = {});

/// Of the worst channels, at most so many, and of different stages where there are: the series that differs worst, with
/// a heading and a plot whose mark stands at the channel's first difference. Curves that would look the same are shown
/// by their difference.
std::string worst_plots(const Trace& golden, const Trace& run, const Comparison& comparison, std::size_t channels);

}  // namespace rehearse
