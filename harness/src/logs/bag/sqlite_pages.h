// The rows of a table in a damaged database, read from its pages: the tree above them isn't used.
//
// Format: "Database File Format" of SQLite, sections 1.3 (header), 1.6 (pages of tables, overflow) and 2.1 (records).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <istream>
#include <optional>
#include <span>
#include <vector>

namespace rehearse::bag {

/// A table with two columns of integers and one of bytes that are read, by their places in its rows.
struct TableForm {
  std::size_t columns = 0;
  std::size_t topic = 0, time = 0, data = 0;
  std::function<bool(std::int64_t)> is_topic;  // rows of other topics aren't of the table
};

/// A row, and the place of its cell.
struct PageRow {
  std::int64_t id = 0;
  std::int64_t topic = 0;
  std::int64_t time = 0;
  std::uint32_t page = 0;
  std::uint32_t cell = 0;  // offset in the page [bytes]
};

class TablePages {
 public:
  TablePages(std::istream& file, TableForm form);

  /// The rows whose cells can be read, in the order of their ids. Where most rows of a page are numbered without a gap,
  /// all are: a row id that contradicts them is replaced.
  std::vector<PageRow> rows();
  /// The bytes of a row, which is asked for once; nullopt: a page in which they continue is missing, or is another row's.
  std::optional<std::span<const std::byte>> data_of(const PageRow& row);
  /// True if the file has fewer pages than it states.
  bool is_cut() const { return is_cut_; }

 private:
  struct Cell;
  bool load(std::uint32_t page);
  std::optional<Cell> cell_at(std::uint32_t offset) const;
  std::vector<PageRow> rows_of_page();

  std::istream& file_;
  TableForm form_;
  std::uint32_t page_size_ = 0, used_ = 0, pages_ = 0;  // used_: bytes of a page without the reserved ones
  std::uint32_t unread_ = 0;  // pages in which rows may continue: each belongs to one row
  bool is_cut_ = false;
  std::uint32_t loaded_ = 0;  // number of the page in bytes_; 0: none
  std::vector<std::byte> bytes_, payload_;
};

}  // namespace rehearse::bag
