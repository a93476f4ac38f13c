#include "sqlite_pages.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace rehearse::bag {
namespace {

constexpr std::size_t header_size = 100;  // of the file, at the beginning of the first page
constexpr std::byte leaf_of_table{0x0d};
constexpr std::size_t leaf_header = 8;
constexpr std::uint32_t smallest_page = 512, largest_page = 65536;

std::uint64_t big_endian(std::span<const std::byte> bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | std::to_integer<std::uint64_t>(bytes[at + i]);
  return value;
}

/// Reads numbers of SQLite's variable length. `is_good` turns false at the end of the bytes.
struct Varints {
  std::span<const std::byte> bytes;
  std::size_t at = 0;
  bool is_good = true;

  std::uint64_t next() {
    std::uint64_t value = 0;
    for (int i = 0; i < 9; ++i) {
      if (at >= bytes.size()) {
        is_good = false;
        return 0;
      }
      const auto byte = std::to_integer<std::uint64_t>(bytes[at++]);
      if (i == 8) return value << 8 | byte;
      value = value << 7 | (byte & 0x7f);
      if (byte < 0x80) break;
    }
    return value;
  }
};

/// The bytes of a value by its serial type; nullopt: there is no such type.
std::optional<std::uint64_t> size_of(std::uint64_t type) {
  constexpr std::array<std::uint64_t, 10> sizes{0, 1, 2, 3, 4, 6, 8, 8, 0, 0};
  if (type < sizes.size()) return sizes[type];
  if (type < 12) return std::nullopt;
  return (type - 12) / 2;
}

bool is_integer(std::uint64_t type) { return (type >= 1 && type <= 6) || type == 8 || type == 9; }
bool is_blob(std::uint64_t type) { return type >= 12 && type % 2 == 0; }

std::int64_t integer_at(std::span<const std::byte> bytes, std::size_t at, std::uint64_t type) {
  if (type == 8 || type == 9) return static_cast<std::int64_t>(type - 8);
  const std::size_t size = *size_of(type);
  const auto unused = static_cast<unsigned>(64 - 8 * size);
  return static_cast<std::int64_t>(big_endian(bytes, at, size) << unused) >> unused;  // with its sign
}

}  // namespace

/// A cell whose record has the form of the table.
struct TablePages::Cell {
  std::int64_t id = 0, topic = 0, time = 0;
  std::uint64_t payload = 0;         // size [bytes]
  std::size_t begin = 0;             // of the payload in the page
  std::size_t local = 0;             // bytes of the payload in the page
  std::uint64_t data = 0, size = 0;  // place of the data in the payload
};

TablePages::TablePages(std::istream& file, TableForm form) : file_(file), form_(std::move(form)) {
  file_.clear();
  std::array<std::byte, header_size> header{};
  file_.seekg(0, std::ios::end);
  const auto size = static_cast<std::uint64_t>(std::max<std::streamoff>(file_.tellg(), 0));
  file_.seekg(0);
  if (!file_.read(reinterpret_cast<char*>(header.data()), header.size())) return;
  const auto stated_size = static_cast<std::uint32_t>(big_endian(header, 16, 2));
  page_size_ = stated_size == 1 ? largest_page : stated_size;
  if (page_size_ < smallest_page || (page_size_ & (page_size_ - 1)) != 0) return;
  used_ = page_size_ - static_cast<std::uint32_t>(big_endian(header, 20, 1));
  pages_ = static_cast<std::uint32_t>(size / page_size_);
  is_cut_ = pages_ < big_endian(header, 28, 4);
  unread_ = pages_;
  bytes_.resize(page_size_);
}

bool TablePages::load(std::uint32_t page) {
  if (page == 0 || page > pages_) return false;
  if (page == loaded_) return true;
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(page - 1) * page_size_);
  loaded_ = file_.read(reinterpret_cast<char*>(bytes_.data()), page_size_) ? page : 0;
  return loaded_ != 0;
}

std::optional<TablePages::Cell> TablePages::cell_at(std::uint32_t offset) const {
  const std::span<const std::byte> page = std::span(bytes_).first(used_);
  Cell cell;
  Varints numbers{page, offset};
  cell.payload = numbers.next();
  cell.id = static_cast<std::int64_t>(numbers.next());
  cell.begin = numbers.at;
  if (!numbers.is_good || cell.payload > std::uint64_t{pages_} * page_size_) return std::nullopt;
  const std::uint64_t most = used_ - 35, least = (used_ - 12) * 32 / 255 - 23;
  const std::uint64_t rest = least + (cell.payload - least) % (used_ - 4);
  cell.local = cell.payload <= most ? cell.payload : rest <= most ? rest : least;
  if (cell.begin + cell.local + (cell.local < cell.payload ? 4 : 0) > used_) return std::nullopt;

  Varints types{page.subspan(cell.begin, cell.local)};
  std::uint64_t at = types.next();
  const std::uint64_t header = at;
  for (std::size_t column = 0; types.is_good && types.at < header; ++column) {
    const std::uint64_t type = types.next();
    const auto size = size_of(type);
    if (!types.is_good || !size || column == form_.columns || at + *size > cell.payload) return std::nullopt;
    if (column == form_.topic || column == form_.time) {
      if (!is_integer(type) || at + *size > cell.local) return std::nullopt;
      (column == form_.topic ? cell.topic : cell.time) = integer_at(types.bytes, at, type);
    } else if (column == form_.data) {
      if (!is_blob(type)) return std::nullopt;
      cell.data = at;
      cell.size = *size;
    }
    at += *size;
    if (types.at == header && column + 1 == form_.columns && at == cell.payload && cell.time >= 0 &&
        form_.is_topic(cell.topic))
      return cell;
  }
  return std::nullopt;
}

std::vector<PageRow> TablePages::rows_of_page() {
  std::vector<PageRow> rows;
  const std::size_t head = loaded_ == 1 ? header_size : 0;
  if (bytes_[head] != leaf_of_table) return rows;
  const std::size_t count = big_endian(bytes_, head + 3, 2);
  if (head + leaf_header + 2 * count > used_) return rows;
  std::vector<std::uint64_t> places;            // of the rows in the page
  std::map<std::uint64_t, std::size_t> firsts;  // the id of the page's first row by each row, and how many state it
  for (std::size_t i = 0; i < count; ++i) {
    const auto offset = static_cast<std::uint32_t>(big_endian(bytes_, head + leaf_header + 2 * i, 2));
    const auto cell = cell_at(offset);
    if (!cell) continue;
    rows.push_back({cell->id, cell->topic, cell->time, loaded_, offset});
    places.push_back(i);
    ++firsts[static_cast<std::uint64_t>(cell->id) - i];
  }
  const auto first = std::ranges::max_element(firsts, {}, [](const auto& entry) { return entry.second; });
  if (first == firsts.end() || 2 * first->second <= rows.size()) return rows;
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].id = static_cast<std::int64_t>(first->first + places[i]);
  return rows;
}

std::vector<PageRow> TablePages::rows() {
  std::vector<PageRow> all;
  for (std::uint32_t page = 1; page <= pages_; ++page) {
    if (!load(page)) continue;
    const std::vector<PageRow> found = rows_of_page();
    all.insert(all.end(), found.begin(), found.end());
  }
  std::ranges::stable_sort(all, {}, &PageRow::id);
  const auto is_copy = [](const PageRow& a, const PageRow& b) {  // of a page that was moved
    return a.id == b.id && a.topic == b.topic && a.time == b.time;
  };
  all.erase(std::unique(all.begin(), all.end(), is_copy), all.end());
  return all;
}

std::optional<std::span<const std::byte>> TablePages::data_of(const PageRow& row) {
  if (!load(row.page)) return std::nullopt;
  const auto cell = cell_at(row.cell);
  if (!cell) return std::nullopt;
  const auto local = std::span(bytes_).subspan(cell->begin, cell->local);
  payload_.assign(local.begin(), local.end());
  if (cell->local < cell->payload) {
    auto next = static_cast<std::uint32_t>(big_endian(bytes_, cell->begin + cell->local, 4));
    while (payload_.size() < cell->payload) {
      if (unread_ == 0 || !load(next)) return std::nullopt;
      --unread_;
      const std::size_t part = std::min<std::size_t>(used_ - 4, cell->payload - payload_.size());
      payload_.insert(payload_.end(), bytes_.begin() + 4, bytes_.begin() + 4 + static_cast<std::ptrdiff_t>(part));
      next = static_cast<std::uint32_t>(big_endian(bytes_, 0, 4));
    }
  }
  return std::span(payload_).subspan(cell->data, cell->size);
}

}  // namespace rehearse::bag
