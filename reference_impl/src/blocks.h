// The blocks of a film that packets cover: about square, in tiles of 16 × 16 blocks, row by row, so that neighbours follow each other.
//
// Static, because files of different instruction sets include it, and these must not share a copy (lanes.h).
#pragma once

#include <cstddef>

namespace equilux {

constexpr int blocks_along_tile = 16, blocks_per_tile = blocks_along_tile * blocks_along_tile;

// Of a block of 4, 8 or 16 pixels, one per lane, row by row.
static constexpr int block_columns(int lanes) { return lanes == 4 ? 2 : 4; }
static constexpr int block_rows(int lanes) { return lanes / block_columns(lanes); }

static inline int tiles_along(int pixels, int pixels_of_block) {
  const int pixels_of_tile = pixels_of_block * blocks_along_tile;
  return (pixels + pixels_of_tile - 1) / pixels_of_tile;
}

// The blocks of whole tiles; some may lie beyond the film.
static inline std::size_t block_count(int lanes, int width, int height) {
  const int across = tiles_along(width, block_columns(lanes)), down = tiles_along(height, block_rows(lanes));
  return static_cast<std::size_t>(across) * static_cast<std::size_t>(down) * blocks_per_tile;
}

struct PixelAt {
  int column, row;
};

// The top left pixel of a block.
static inline PixelAt block_at(int lanes, int width, std::size_t index) {
  const int in_tile = static_cast<int>(index % blocks_per_tile), tile = static_cast<int>(index / blocks_per_tile);
  const int across = tiles_along(width, block_columns(lanes));
  return {(tile % across * blocks_along_tile + in_tile % blocks_along_tile) * block_columns(lanes),
          (tile / across * blocks_along_tile + in_tile / blocks_along_tile) * block_rows(lanes)};
}

static inline PixelAt pixel_of_lane(int lanes, PixelAt block, int lane) {
  return {block.column + lane % block_columns(lanes), block.row + lane / block_columns(lanes)};
}

}  // namespace equilux
