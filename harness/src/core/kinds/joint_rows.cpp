#include "joint_rows.h"

#include <cstring>
#include <utility>

#include "joint_arrays.h"

namespace rehearse {
namespace {

/// Reads the rows of JointState and JointAccelerations: arrays that belong to an array of names. While the layout stays
/// the same, the arrays are copied as a whole.
class NamedArraysReader : public RowReader {
 public:
  /// `suffixes` name the arrays that follow the names, in order: "/q", "/dq", "/u".
  NamedArraysReader(TraceChannel& channel, std::vector<std::string_view> suffixes)
      : channel_(channel), row_(channel), suffixes_(std::move(suffixes)), joints_(suffixes_.size()) {}

  bool read(std::span<const std::byte> payload) override {
    if (!joints_.read(payload)) return false;
    row_.begin_row();
    if (!joints_.layout_changed() && columns_are_arrays_ && channel_.columns.size() == column_count()) {
      copy_row();
    } else {
      put_row();
    }
    return true;
  }

 private:
  std::size_t column_count() const {
    std::size_t count = 0;
    for (const auto& array : joints_.all()) count += array.size();
    return count;
  }

  void copy_row() {
    for (const auto& array : joints_.all()) {
      if (!array.empty())
        std::memcpy(row_.next_cells(array.size()).data(), array.data(), array.size() * sizeof(double));
    }
  }

  void put_row() {
    bool in_order = true;
    std::size_t column = 0;
    std::string element;
    const std::vector<std::string>& names = joints_.names();
    for (std::size_t a = 0; a < suffixes_.size(); ++a) {
      const std::vector<double>& array = joints_.all()[a];
      for (std::size_t i = 0; i < array.size(); ++i) {
        element = i < names.size() ? names[i] : std::to_string(i);
        element += suffixes_[a];
        row_.put(element, array[i]);
        in_order = in_order && column < channel_.columns.size() && channel_.columns[column].element == element;
        ++column;
      }
    }
    // Then column k contains element k of the arrays in a row; not if names occur twice or other columns came before.
    columns_are_arrays_ = in_order && channel_.columns.size() == column_count();
  }

  TraceChannel& channel_;
  RowWriter row_;
  const std::vector<std::string_view> suffixes_;
  JointArrays joints_;
  bool columns_are_arrays_ = false;
};

}  // namespace

std::unique_ptr<RowReader> joint_rows(TraceChannel& channel, std::vector<std::string_view> suffixes) {
  return std::make_unique<NamedArraysReader>(channel, std::move(suffixes));
}

}  // namespace rehearse
