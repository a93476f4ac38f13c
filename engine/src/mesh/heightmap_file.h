// Reads heightmaps: the ground of a landscape from a grey picture or a grid of numbers.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <filesystem>
#include <string>

namespace rehearse {

inline constexpr int max_heightmap_side = 2049;  // [points]

struct HeightmapSettings {
  Eigen::Vector2d size = Eigen::Vector2d::Zero();  // full extents along x and y [m]
  double height = 1.0;  // of a picture: of white over black; of a grid: the factor of its numbers [m]
};

/// The bytes of a heightmap's file. Errors contain the path as their file.
Result<std::string> read_heightmap_file(const std::filesystem::path& file);

/// The ground that the bytes of a file describe. A file named *.png is a grey picture of 8 or 16 bits: black is at
/// z = 0, and a pixel is a point of the grid. Any other file is a grid in text: lines of the same count of numbers
/// between blanks or commas; `#` begins a comment. The picture's top row and the text's first line have the largest y.
/// Fails with the line and column if the bytes are neither, if a number isn't finite, and if a side has fewer than 2 or
/// more than max_heightmap_side points. `name` is used in messages and as Mesh::file.
Result<Mesh> read_heightmap(const std::string& bytes, const std::string& name, const HeightmapSettings& settings);

}  // namespace rehearse
