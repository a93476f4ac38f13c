// The joystick of the run.
#include <iterator>
#include <sstream>

#include "kind.h"
#include "rows.h"

namespace rehearse {
namespace {

/// The channel's metadata may state the names of its axes and buttons, separated by blanks, under `axes` and `buttons`.
/// Without them, numbers are used.
class JoystickNames {
 public:
  explicit JoystickNames(const TraceChannel& channel)
      : axes_(names(channel, "axes")), buttons_(names(channel, "buttons")) {}

  const std::string& axis(std::size_t index) { return element(axes_, "axes", index); }
  const std::string& button(std::size_t index) { return element(buttons_, "buttons", index); }

 private:
  static std::vector<std::string> names(const TraceChannel& channel, const std::string& array) {
    const auto stated = channel.metadata.find(array);
    if (stated == channel.metadata.end()) return {};
    std::istringstream words(stated->second);
    return {std::istream_iterator<std::string>(words), {}};
  }

  const std::string& element(const std::vector<std::string>& names, const char* array, std::size_t index) {
    element_ = array;
    element_ += '/';
    element_ += index < names.size() ? names[index] : std::to_string(index);
    return element_;
  }

  std::vector<std::string> axes_, buttons_;
  std::string element_;
};

}  // namespace

const ChannelForm joystick_kind{
    .level = ChannelForm::Level::run,
    .segment = "joy",
    .type = msg::Joy::type_name,
    .schema = msg::schema_text<msg::Joy>,
    .stage = Stage::inputs,
    .make_rows = [](TraceChannel& channel, const std::string&) {
      return rows_of<msg::Joy>(channel, [names = JoystickNames(channel)](const msg::Joy& joy, RowWriter& row) mutable {
        for (std::size_t i = 0; i < joy.axes.size(); ++i) row.put(names.axis(i), joy.axes[i]);
        for (std::size_t i = 0; i < joy.buttons.size(); ++i)
          row.put(names.button(i), CellKind::signed_integer, static_cast<std::uint64_t>(std::int64_t{joy.buttons[i]}));
      });
    }};

}  // namespace rehearse
