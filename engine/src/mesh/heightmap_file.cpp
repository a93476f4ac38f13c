#include "heightmap_file.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text.h"
#include "mesh_input.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

Diagnostic at(const std::string& name, std::string message, std::string hint, int line = 0, int column = 0) {
  Diagnostic finding = error_in(name, std::move(message), std::move(hint));
  finding.line = line;
  finding.column = column;
  return finding;
}

/// A message if a heightmap can't have this count of points.
std::optional<std::string> wrong_size(std::size_t columns, std::size_t rows) {
  constexpr std::size_t least = 2, most = max_heightmap_side;
  if (columns >= least && rows >= least && columns <= most && rows <= most) return std::nullopt;
  return fmt::format("the heightmap has {} x {} points", columns, rows);
}

const std::string size_hint = fmt::format("expected 2 to {} points along each side", max_heightmap_side);

/// libpng's reader of bytes in memory. At an error libpng jumps back to read(), over C code only.
class GreyPicture {
 public:
  explicit GreyPicture(std::string_view bytes) : bytes_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore);
    info_ = png_ ? png_create_info_struct(png_) : nullptr;
  }
  ~GreyPicture() { png_destroy_read_struct(&png_, &info_, nullptr); }
  GreyPicture(const GreyPicture&) = delete;
  GreyPicture& operator=(const GreyPicture&) = delete;

  /// False: see message().
  bool read_header() {
    if (!info_ || setjmp(back_) != 0) return false;
    png_set_read_fn(png_, this, read_bytes);
    png_read_info(png_, info_);
    return true;
  }
  /// The samples, row by row, 0 to 1. False: see message().
  bool read(std::vector<double>& samples) {
    png_set_expand(png_);
    png_set_strip_alpha(png_);
    const int depth = std::max<int>(8, png_get_bit_depth(png_, info_));
    constexpr std::size_t room = 4;  // for a pixel with alpha, of 16 bits [bytes]
    std::vector<std::uint8_t> pixels(room * width() * height());
    std::vector<png_bytep> rows(height());
    for (std::size_t row = 0; row < rows.size(); ++row) rows[row] = pixels.data() + row * room * width();
    if (!read_rows(rows.data())) return false;
    const std::size_t bytes = static_cast<std::size_t>(depth) / 8;
    for (const std::uint8_t* row : rows)
      for (std::size_t i = 0; i < width(); ++i)
        samples.push_back(bytes == 1 ? row[i] / 255.0 : (256 * row[2 * i] + row[2 * i + 1]) / 65535.0);
    return true;
  }
  bool is_grey() const { return (png_get_color_type(png_, info_) & PNG_COLOR_MASK_COLOR) == 0; }
  std::size_t width() const { return png_get_image_width(png_, info_); }
  std::size_t height() const { return png_get_image_height(png_, info_); }
  const std::string& message() const { return message_; }

 private:
  bool read_rows(png_bytepp rows) {
    if (setjmp(back_) != 0) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }
  static void fail(png_structp png, png_const_charp message) {
    auto& self = *static_cast<GreyPicture*>(png_get_error_ptr(png));
    self.message_ = message;
    std::longjmp(self.back_, 1);
  }
  static void ignore(png_structp, png_const_charp) {}
  static void read_bytes(png_structp png, png_bytep to, std::size_t count) {
    auto& self = *static_cast<GreyPicture*>(png_get_io_ptr(png));
    if (count > self.bytes_.size()) png_error(png, "it ends too early");
    std::memcpy(to, self.bytes_.data(), count);
    self.bytes_.remove_prefix(count);
  }

  std::string_view bytes_;
  std::string message_ = "libpng can't be used";
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::jmp_buf back_{};
};

Result<void> read_picture(const std::string& bytes, const std::string& name, Heightmap& map) {
  GreyPicture picture(bytes);
  if (!picture.read_header())
    return at(name, "the heightmap isn't a PNG: " + picture.message(), "save it as a grey PNG of 8 or 16 bits");
  if (const auto problem = wrong_size(picture.width(), picture.height())) return at(name, *problem, size_hint);
  if (!picture.is_grey())
    return at(name, "the heightmap is a picture in colour", "save it as a grey PNG of 8 or 16 bits");
  if (!picture.read(map.heights))
    return at(name, "the heightmap can't be read: " + picture.message(), "save it as a grey PNG of 8 or 16 bits");
  map.columns = static_cast<int>(picture.width());
  map.rows = static_cast<int>(picture.height());
  return {};
}

/// Adds the numbers of a line.
Result<void> read_line(std::string_view line, const std::string& name, int number, std::vector<double>& heights) {
  constexpr std::string_view between = " \t\r,";
  const char* const begin = line.data();
  line = line.substr(0, line.find('#'));
  for (;;) {
    line.remove_prefix(std::min(line.find_first_not_of(between), line.size()));
    if (line.empty()) return {};
    const std::string_view word = line.substr(0, line.find_first_of(between));
    const int column = static_cast<int>(line.data() - begin) + 1;
    const auto value = number_in<double>(word);
    if (!value || !std::isfinite(*value))
      return at(name, fmt::format("'{}' is no height", word.substr(0, 40)), "expected a finite number [m]", number,
                column);
    heights.push_back(*value);
    line.remove_prefix(word.size());
  }
}

Result<void> read_grid(std::string_view text, const std::string& name, Heightmap& map) {
  std::size_t columns = 0, rows = 0;
  for (int number = 1; !text.empty(); ++number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t before = map.heights.size();
    REHEARSE_TRY(read_line(line, name, number, map.heights));
    const std::size_t count = map.heights.size() - before;
    if (count == 0) continue;
    if (rows > 0 && count != columns)
      return at(name, fmt::format("the line has {} heights, and the first has {}", count, columns),
                "a grid has as many numbers in each line", number);
    columns = count;
    ++rows;
    if (columns > max_heightmap_side || rows > max_heightmap_side) break;
  }
  if (const auto problem = wrong_size(columns, rows)) return at(name, *problem, size_hint);
  map.columns = static_cast<int>(columns);
  map.rows = static_cast<int>(rows);
  return {};
}

/// Upwards, perpendicular to the slope between the neighbours of a point.
Vector3d normal_at(const Heightmap& map, int column, int row) {
  const Vector3d x = map.point(std::min(column + 1, map.columns - 1), row) - map.point(std::max(column - 1, 0), row);
  const Vector3d y = map.point(column, std::max(row - 1, 0)) - map.point(column, std::min(row + 1, map.rows - 1));
  return x.cross(y).normalized();
}

/// The surface, for pictures.
MeshData surface_of(const Heightmap& map, const std::string& name) {
  MeshPart part;
  const auto index = [&map](int column, int row) { return static_cast<std::uint32_t>(row * map.columns + column); };
  Eigen::AlignedBox3d box;
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      box.extend(map.point(column, row));
      part.vertices.push_back(map.point(column, row).cast<float>());
      part.normals.push_back(normal_at(map, column, row).cast<float>());
      if (row + 1 == map.rows || column + 1 == map.columns) continue;
      part.triangles.push_back({index(column, row), index(column, row + 1), index(column + 1, row)});
      part.triangles.push_back({index(column + 1, row), index(column, row + 1), index(column + 1, row + 1)});
    }
  }
  MeshData data;
  data.file = name;
  data.parts.push_back(std::move(part));
  data.lower = box.min();
  data.upper = box.max();
  return data;
}

}  // namespace

Result<std::string> read_heightmap_file(const std::filesystem::path& file) { return read_mesh_file(file); }

Result<Mesh> read_heightmap(const std::string& bytes, const std::string& name, const HeightmapSettings& settings) {
  auto map = std::make_shared<Heightmap>();
  map->size = settings.size;
  const bool is_picture = std::filesystem::path(name).extension() == ".png";
  REHEARSE_TRY(is_picture ? read_picture(bytes, name, *map) : read_grid(bytes, name, *map));
  for (double& height : map->heights) height *= settings.height;
  Mesh mesh;
  mesh.data = std::make_shared<const MeshData>(surface_of(*map, name));
  mesh.file = name;
  mesh.heightmap = std::move(map);
  return mesh;
}

}  // namespace rehearse
