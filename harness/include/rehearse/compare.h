// Comparison: two traces of one run, value by value. It reports which values differ, where first, and by how much.
//
// It has three results. `equal`: every number, picture and event has the same bits. `within`: every value is within its
// tolerance (scenario.h). The places: the first beyond tolerance, the first where bits differ, the worst.
//
// Messages of a channel are matched by their time, rows of tables by the names of their elements. An item that only one
// trace contains is a finding with its place. A missing tick, body, controller or device is one finding for all its
// channels. A channel or device that only one run has comes after all other differences, whatever its tick. An input
// that a controller reads in one of the runs only is a remark: the controller may command the same.
// The hashes in /tick are no quantities: they state whether bits are equal and up to which tick, and fail nothing; that
// of the inputs isn't compared if controllers read other inputs. Integers and booleans are exact. NaN equals NaN of the
// same tick; -0 and 0 have different bits and are the same number.
//
// Two orientations are compared by the angle between them, 2 atan2(|v|, |w|) of q_golden^-1 q_actual = (v, w), so q and
// -q are equal; their norms are compared separately. An angle whose channel has `wrap:<element>` in its metadata is
// compared modulo one turn. Recordings of this project have this entry for no joint: joints count turns, and a robot
// that has made one more turn is in a different place.
//
// Events are compared as sequences, separately for each kind and owner. The kinds are: contacts that begin and end
// (/contacts), joints at the limits that the simulation enforces (`limits:` of a body's /joints), control() that
// returns false (/tick), and messages (/events). First the events of the golden and of the run are aligned in order. An
// event that is missing, extra or in a different order is a finding; so is one that is early or late by more ticks than
// allowed. A contact or a limit may be off by one tick: the last bit of a number decides in which of two steps a
// threshold is crossed. A contact or a limit that lasts no longer than one tick may also be missing or extra. All other
// events must be in the same tick. A rule with `ticks` changes this. Where it accepts an event that is early or late,
// the numbers of the concerned bodies are not judged between the two ticks.
//
// "First" is by tick. Within one tick the order is that of cause and effect: the state of the bodies, the measurements
// of sensors, the pictures that arrive, the inputs that are copied from these, the commands computed from the inputs.
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
#include <utility>
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
  double difference = 0.0;  // |actual - expected|, for angles the angle between them; 0 if both are NaN, NaN if one is
  std::uint64_t ulps = 0;   // number of representable numbers between them; the largest value if either is NaN
  double tolerance = 0.0;   // allowed difference; 0: bit for bit
  /// The distance from the golden's values within lead and lag, if the value of the same tick isn't near enough. The
  /// tolerance then applies to it instead of the difference.
  std::optional<double> distance_from_envelope = std::nullopt;
  std::string unit;  // may be empty
  std::string note;  // for a difference that isn't one of two numbers: "missing", "120 pixels differ, ..."
  Stage stage = Stage::controller;

  /// What the tolerance applies to.
  double judged() const { return distance_from_envelope.value_or(difference); }
  /// True for a difference beyond its tolerance, or one with a note.
  bool is_beyond() const { return !note.empty() || !(judged() <= tolerance); }
};

/// Differences between two runs.
struct Differences {
  std::int64_t values = 0;  // numbers compared
  std::int64_t values_different = 0;
  std::optional<Divergence> first;
  /// By multiples of its tolerance; of differences without tolerance, by difference.
  std::optional<Divergence> worst;
  std::optional<Divergence> beyond;  // the first beyond its tolerance, or with a note
  /// By multiples of its tolerance of the difference of the same tick, whatever lead and lag allow.
  std::optional<Divergence> largest;
  std::uint64_t most_ulps = 0;  // the largest Divergence::ulps of a difference without a note

  void add(Divergence found) {
    const bool is_beyond = found.is_beyond();
    add(std::move(found), is_beyond);
  }
  /// It may be of an earlier tick than the differences so far.
  void add(Divergence found, bool is_beyond);
};

/// Sets the members that two numbers determine: expected, actual, difference, ulps and unit.
void put_numbers(Divergence& divergence, double expected, double actual, std::string_view unit = {});

/// The difference relative to the expected value. NaN where this has no meaning: angles between orientations, angles
/// modulo a turn, differences other than of two numbers.
double relative_difference(const Divergence& divergence);

/// The difference as a multiple of its tolerance; infinity if no difference is allowed.
double times_tolerance(double difference, double tolerance);

/// One sentence: tick, time, channel, element, expected, actual, absolute and relative difference, ULPs, times the
/// tolerance, and stage.
std::string to_string(const Divergence& divergence);

/// A JSON object with all members, and relative and times_tolerance; beside only where it is known. For a difference
/// that isn't one of two numbers, expected, actual, difference, relative, ulps, tolerance and times_tolerance are null.
/// NaN and infinities are strings.
std::string to_json(const Divergence& divergence);

/// The number of steps from one double to the next between a and b; 0 for equal bits and for 0 and -0. NaN with any
/// different bits: the largest value.
std::uint64_t ulps_between(double a, double b);

/// True if both have the same bits.
bool identical(double a, double b);

/// The largest difference of one series of numbers from its golden.
struct SeriesComparison {
  std::string element;     // for an orientation without its axis
  std::string unit;        // rad for an orientation
  double largest = 0.0;    // largest difference; for angles the angle; NaN if one of two numbers was NaN
  double tolerance = 0.0;  // the tolerance that was applied
};

/// The result for one channel, or for several channels with one common absence.
struct ChannelComparison {
  std::string channel;  // topic; the first one for several channels
  Stage stage = Stage::physics;
  int channels = 1;            // number of channels; a missing body lacks several
  std::string group;           // common beginning of the topics if there are several channels: "/SR1/LeftCamera/"
  bool of_events = false;      // it counts the events on the channel, not its values
  bool is_lone = false;        // only one of the traces has it; not of a whole body or controller
  std::int64_t values = 0;     // number of compared numbers, pictures, or events
  std::int64_t differing = 0;  // values with different bits
  std::int64_t in_noise = 0;   // differing values up to the noise floor
  std::int64_t beyond = 0;     // differing values beyond tolerance
  /// Differing values that were not judged, because an event nearby is early or late within its tolerance.
  std::int64_t blanked = 0;
  std::int64_t missing = 0;             // messages that only the golden contains, in ticks of both traces
  std::int64_t extra = 0;               // messages that only the other trace contains, likewise
  std::optional<Divergence> first;      // beyond tolerance, or missing
  std::optional<Divergence> first_bit;  // in any bit, or missing
  std::optional<Divergence> worst;      // by multiples of its tolerance, then by difference
  /// All series except integers. For pictures: the largest difference of a colour, "of 255", and the largest share "of
  /// pixels" that differ by more than the tolerance of a pixel.
  std::vector<SeriesComparison> series;
};

/// An event at a different tick than in the golden.
struct EventDifference {
  std::string event;                     // name of its sequence, as in tolerance rules: contacts/Box/Box/Floor/Floor
  std::string what;                      // "begins", "ends"
  std::optional<std::int64_t> expected;  // tick in the golden; none: it is extra
  std::optional<std::int64_t> actual;    // tick in the run; none: it is missing
  bool beyond = false;                   // the difference is larger than allowed
};

/// The agreement of two runs, by the largest difference.
enum class Agreement {
  equal,     // all bits are equal
  in_noise,  // no difference is above its noise floor
  within,    // all differences are within tolerance
  beyond,    // a value is beyond tolerance, missing or extra
};

/// "equal", "in noise", "within" or "beyond".
std::string_view to_string(Agreement agreement);

struct Comparison {
  bool equal = false;   // all bits are equal
  bool within = false;  // nothing beyond tolerance, nothing missing, nothing extra; true if equal
  Agreement agreement = Agreement::equal;
  std::int64_t ticks = 0;               // number of compared ticks
  std::int64_t values = 0;              // compared numbers, pictures and events
  std::int64_t pictures = 0;            // compared pictures
  std::int64_t events = 0;              // compared events
  std::int64_t differing = 0;           // values with different bits
  std::int64_t in_noise = 0;            // differing values up to the noise floor
  std::int64_t beyond = 0;              // differing values beyond tolerance
  std::int64_t blanked = 0;             // differing values that were not judged
  std::optional<Divergence> first;      // beyond tolerance, or missing
  std::optional<Divergence> first_bit;  // first place with any different bit, hashes included
  /// By multiples of its tolerance. A value without tolerance is the worst only if no other value is beyond its
  /// tolerance.
  std::optional<Divergence> worst;
  std::string explanation;  // other changes that may have caused the first difference: "the renderer"; or empty
  std::vector<ChannelComparison> channels;         // all channels with any difference, by their first_bit
  std::vector<ChannelComparison> same;             // all other channels that were compared
  std::vector<std::string> equal_channels;         // topics of all channels without difference, in the golden's order
  std::vector<EventDifference> event_differences;  // by tick, the first thousand
  /// Inputs that controllers read in the golden only ("- Rig/Gyro"), or in the run only ("+ KNEE/dq of Rig/C"). They
  /// fail nothing, because the commands may be equal.
  std::vector<std::string> other_inputs;
  /// Sentences about messages of logs that can't be decoded, and are compared by their bytes; also among the remarks.
  std::vector<std::string> undecoded;
  /// Channels that only one run has, which is no difference: sentences, also among the remarks.
  std::vector<std::string> not_compared;
  std::vector<std::string> changed_files;  // attachments whose content differs from the golden's
  bool same_arithmetic = true;             // versions and pins that influence bits are equal to the golden's
  /// All sources that the traces state are equal: scenario, models, controllers, the same programs byte for byte. Then
  /// their bits must be equal. False if one of the traces states no sources.
  bool same_origin = false;
  /// The only differences are lines that controllers write, and no rule compares these.
  bool words_alone = false;
  /// Causes or likely causes of a difference: a different scenario, model, controller, library. Sentences.
  std::vector<std::string> remarks;
  /// Mistakes in the request that the user can correct: rules that match nothing.
  Diagnostics warnings;
};

/// Two numbers or pictures of the same time with different bits.
struct DifferingValue {
  const TraceChannel& channel;            // of the golden
  std::size_t place = 0;                  // index of the channel in the golden
  std::size_t message = 0;                // index of the message in that channel
  std::vector<std::size_t> columns = {};  // one column, or the four of an orientation; none: a picture
  bool beyond = false;                    // the difference is beyond its tolerance
  std::int64_t pixels = 0;                // for a picture: pixels that differ by more than the tolerance of a pixel
};

/// The part of two traces that is compared.
struct CompareOptions {
  /// Stages of the loop whose values are compared; channels of other stages are left out. Empty: all stages.
  std::vector<Stage> stages;
  /// Messages up to this time are compared, inclusive [s]; none: to the end of both runs. A shorter run is still a
  /// finding, unless both runs reach this time.
  std::optional<double> until;
  /// Noise floors by series, in its unit; for an element of an orientation the angle [rad]. A noise floor is the
  /// difference that meaningless perturbations cause. Differences up to it are counted as noise; they pass or fail as
  /// before.
  std::map<std::string, double, std::less<>> noise_floors;
  /// Called with each value that differs, except hashes; null: not. It may be called twice for a value.
  std::function<void(const DifferingValue&)> on_difference;

  bool takes(Stage stage) const;
};

Comparison compare(const Trace& golden, const Trace& actual, const std::vector<ToleranceRule>& rules,
                   const CompareOptions& options = {});

/// Compares two recordings that may be larger than the memory. Each is read once, and differing parts once more, in
/// windows of time whose numbers take about `window_size` bytes. Fails if one of them can't be read.
Result<Comparison> compare(const std::filesystem::path& golden, const std::filesystem::path& actual,
                           const std::vector<ToleranceRule>& rules, const CompareOptions& options = {},
                           std::size_t window_size = Trace::usual_piece_size);

/// Fails if the version of the trace is unknown to this program, so that its contents cannot be interpreted. A
/// comparison with such a trace reports this alone.
Result<void> check_version(const Trace& trace);

/// The tolerances of the scenario that the trace contains; none if it contains no scenario.
Result<std::vector<ToleranceRule>> tolerances_of(const Trace& trace);

/// One sentence, without a full stop.
std::string verdict(const Comparison& comparison);

/// The verdict of a comparison up to a horizon [s], which the sentence states: "up to 2 s equal bit for bit: ...".
std::string verdict(const Comparison& comparison, std::optional<double> until);

/// The differences, with similar channels grouped, and with counts and the worst of each group. Then the worst of all,
/// the channels that are equal bit for bit, remarks and warnings. The table has at most sixteen lines besides warnings,
/// each with its newline and, unless names are long, at most 120 characters. Empty if the traces are equal and there
/// are no warnings, except for a note if controllers read other inputs.
std::string table(const Comparison& comparison);

/// An object with the same content: verdict, equal, within, agreement, first, first_bit, worst (null, or objects as
/// to_json(Divergence)), explanation, counts, channels, equal_channels, events, remarks, warnings.
std::string to_json(const Comparison& comparison);

// Pictures of differences between pictures: expected, actual and difference side by side.

/// For each camera channel with a picture beyond its tolerance, writes the first such picture as PNG: the golden's, the
/// actual one, and the difference. The difference is drawn on a dimmed picture of the golden: red is beyond tolerance,
/// yellow differs within tolerance. Distances are drawn in grey, from white for the smallest to black for the largest;
/// blue marks pixels without a measurement. The files are named after `actual` and the channel:
/// "Run.SR1.LeftCamera.image.png" beside "Run.mcap". Older files of such names are removed first. Returns the written
/// files.
Result<std::vector<std::filesystem::path>> write_picture_differences(const Trace& golden, const Trace& actual,
                                                                     const Comparison& comparison,
                                                                     const std::vector<ToleranceRule>& rules,
                                                                     const std::filesystem::path& beside);

/// "expected, actual and difference: FILE", a line each, each after a newline; or the reason why they couldn't be
/// written.
std::string picture_lines(const Result<std::vector<std::filesystem::path>>& written);

/// Removes the files that write_picture_differences() wrote beside that recording.
void remove_picture_differences(const std::filesystem::path& beside);

// Small plots of series in characters of the terminal: the series of golden and run over time, and their first
// difference.

/// A series to draw. Samples that aren't finite are left out.
struct Curve {
  std::vector<double> times;  // [s], ascending
  std::vector<double> values;
};

struct PlotSize {
  std::size_t width = 78;  // [characters], labels included
  std::size_t height = 7;  // [lines] of the curves; the axis of time takes two more
};

/// Both curves over one axis of time, with a mark below the time of their first difference. Each column shows the range
/// of its samples: ▒ for both curves, ░ for the golden alone, █ for the run alone. The text has lines, each with its
/// newline. If there is nothing to draw, one line reports this.
std::string plot(const Curve& golden, const Curve& run, std::optional<double> mark, PlotSize size = {});

/// Plots of at most `channels` of the worst channels, from different stages if possible. For each channel the series
/// with the worst difference is drawn, with a heading and a mark at the channel's first difference. If both curves
/// would look equal, their difference is drawn instead.
std::string worst_plots(const Trace& golden, const Trace& run, const Comparison& comparison, std::size_t channels);

}  // namespace rehearse
