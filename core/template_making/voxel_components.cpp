#include "core/template_making/voxel_components.h"

#include <algorithm>
#include <functional>

namespace homolog {

namespace {

/// Voxels of one row that follow each other: [first, end).
struct Run {
  int first, end;
  std::int32_t parent;  ///< index of a run of the same part, its own at the root
};

std::int32_t root_of(std::vector<Run>& runs, std::int32_t run) {
  while (runs[run].parent != run) {
    auto& parent = runs[run].parent;
    parent = runs[parent].parent;
    run = parent;
  }
  return run;
}

/// The lower root wins, so that a part's root is its first run.
void join(std::vector<Run>& runs, std::int32_t a, std::int32_t b) {
  a = root_of(runs, a);
  b = root_of(runs, b);
  runs[std::max(a, b)].parent = std::min(a, b);
}

/// Joins the runs of two rows that overlap when one is made longer by `reach` at both ends.
void join_rows(std::vector<Run>& runs, std::int32_t a, std::int32_t a_end, std::int32_t b, std::int32_t b_end,
               int reach) {
  while (a < a_end && b < b_end) {
    const Run &left = runs[a], &right = runs[b];
    const bool a_ends_first = left.end < right.end;
    if (left.first - reach < right.end && right.first < left.end + reach) join(runs, a, b);
    ++(a_ends_first ? a : b);
  }
}

}  // namespace

VoxelComponents connected_components(const std::vector<std::uint8_t>& set, const std::array<int, 3>& dims,
                                     Touching touching) {
  const auto rows = static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(dims[2]);
  const auto width = static_cast<std::size_t>(dims[0]), height = static_cast<std::size_t>(dims[1]);
  std::vector<Run> runs;
  std::vector<std::int32_t> start(rows + 1);  // the first of each row's runs
  const auto join_with = [&](std::size_t row, std::size_t other, int reach) {
    join_rows(runs, start[row], static_cast<std::int32_t>(runs.size()), start[other], start[other + 1], reach);
  };
  for (std::size_t row = 0; row < rows; ++row) {
    start[row] = static_cast<std::int32_t>(runs.size());
    const auto begin = set.begin() + static_cast<std::ptrdiff_t>(row * width), end = begin + dims[0];
    for (auto first = std::find_if(begin, end, [](auto v) { return v != 0; }); first != end;) {
      const auto last = std::find(first, end, 0);
      runs.push_back(
          {static_cast<int>(first - begin), static_cast<int>(last - begin), static_cast<std::int32_t>(runs.size())});
      first = std::find_if(last, end, [](auto v) { return v != 0; });
    }
    const std::size_t j = row % height;
    const bool edges = touching == Touching::faces_and_edges;
    if (j > 0) join_with(row, row - 1, edges ? 1 : 0);
    if (row < height) continue;
    join_with(row, row - height, edges ? 1 : 0);
    if (edges && j > 0) join_with(row, row - height - 1, 0);
    if (edges && j + 1 < height) join_with(row, row - height + 1, 0);
  }
  start[rows] = static_cast<std::int32_t>(runs.size());

  VoxelComponents components;
  components.part.assign(set.size(), -1);
  std::vector<std::int32_t> part_of_run(runs.size());
  for (std::size_t row = 0; row < rows; ++row)
    for (auto r = static_cast<std::size_t>(start[row]); r < static_cast<std::size_t>(start[row + 1]); ++r) {
      const auto root = static_cast<std::size_t>(root_of(runs, static_cast<std::int32_t>(r)));
      if (root == r) {
        part_of_run[r] = static_cast<std::int32_t>(components.sizes.size());
        components.sizes.push_back(0);
      }
      const std::int32_t part = part_of_run[r] = part_of_run[root];
      const auto length = static_cast<std::size_t>(runs[r].end - runs[r].first);
      components.sizes[part] += length;
      std::fill_n(components.part.begin() + static_cast<std::ptrdiff_t>(row * width) + runs[r].first, length, part);
    }
  return components;
}

OneBody make_one_body(std::vector<std::uint8_t>& set, const std::array<int, 3>& dims) {
  OneBody result;
  {
    const auto parts = connected_components(set, dims, Touching::faces);
    if (parts.sizes.empty()) return result;
    const auto largest = std::max_element(parts.sizes.begin(), parts.sizes.end()) - parts.sizes.begin();
    for (std::size_t v = 0; v < set.size(); ++v) set[v] = parts.part[v] == largest;
    for (std::ptrdiff_t part = 0; part < std::ssize(parts.sizes); ++part)
      if (part != largest) result.islands.push_back(parts.sizes[part]);
    std::sort(result.islands.begin(), result.islands.end(), std::greater<>());
    result.body = parts.sizes[largest];
  }
  std::vector<std::uint8_t> outside(set.size());
  std::transform(set.begin(), set.end(), outside.begin(), [](std::uint8_t voxel) { return voxel == 0; });
  const auto parts = connected_components(outside, dims, Touching::faces_and_edges);
  std::vector<char> open(parts.sizes.size(), 0);  // reaches the rim of the grid
  const auto [size_i, size_j, size_k] = dims;
  std::size_t v = 0;
  for (int k = 0; k < size_k; ++k)
    for (int j = 0; j < size_j; ++j) {
      const bool rim_row = j == 0 || k == 0 || j + 1 == size_j || k + 1 == size_k;
      for (int i = 0; i < size_i; ++i, ++v) {
        const bool rim = rim_row || i == 0 || i + 1 == size_i;
        if (rim && parts.part[v] >= 0) open[parts.part[v]] = 1;
      }
    }
  for (std::size_t part = 0; part < open.size(); ++part)
    if (open[part] == 0) {
      ++result.cavities;
      result.cavity_voxels += parts.sizes[part];
    }
  result.body += result.cavity_voxels;
  if (result.cavities == 0) return result;
  for (v = 0; v < set.size(); ++v)
    if (parts.part[v] >= 0 && open[parts.part[v]] == 0) set[v] = 1;
  return result;
}

}  // namespace homolog
