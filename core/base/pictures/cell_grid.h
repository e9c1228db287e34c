#pragma once

#include <algorithm>

namespace homolog {

/// The rows of a grid of `count` cells, which is filled row by row.
inline int rows_of_grid(int count, int columns) {
  return (count + columns - 1) / columns;
}

/// The columns of a grid of `count` cells in an area, whose cells are as near to square as can be.
template <class Length>
int columns_of_grid(int count, Length width, Length height) {
  int best = 1;
  Length longest = 0;  // shorter side of a cell
  for (int columns = 1; columns <= count; ++columns) {
    const Length side =
        std::min(width / static_cast<Length>(columns), height / static_cast<Length>(rows_of_grid(count, columns)));
    if (side > longest) longest = side, best = columns;
  }
  return best;
}

}  // namespace homolog
